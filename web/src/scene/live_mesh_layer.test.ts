import { Ray, Vector3, type Mesh, type ShaderMaterial } from 'three';
import { describe, expect, it } from 'vitest';
import type { MeshCube, MeshPiece, Pose, ScanEvent } from '../connection/events';
import { initialViewOptions } from '../state/view_options';
import { LiveMeshLayer } from './live_mesh_layer';
import { coverageMode } from './mesh_material';
import { SubmapsLayer } from './submaps_layer';

const cube = (x: number): MeshCube => ({ part: 0, x, y: 0, z: 0 });
const pose = (x: number): Pose => ({ translation: [x, 0, 0], rotation: [0, 0, 0, 1] });

function triangle(): MeshPiece {
  return {
    triangles: 1,
    index: Uint32Array.of(0, 1, 2),
    positions_m: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0),
    normals: new Int8Array(12).fill(127),
    colors: new Uint8Array(12).fill(255),
    hasConfidences: false,
  };
}

function seen(confidence: number): MeshPiece {
  return { ...triangle(), colors: new Uint8Array(12).fill(8 * confidence), hasConfidences: true };
}

const piece = (x: number, submap: number, mesh: MeshPiece | null = triangle()): ScanEvent => ({
  kind: 'meshChunk',
  cube: cube(x),
  version: 1n,
  submap,
  piece: mesh,
});

function world(): { submaps: SubmapsLayer; layer: LiveMeshLayer; say: (event: ScanEvent) => void } {
  const submaps = new SubmapsLayer();
  const layer = new LiveMeshLayer(submaps);
  layer.onOptions(initialViewOptions);
  return {
    submaps,
    layer,
    say: (event) => {
      submaps.onEvent(event);
      layer.onEvent(event);
    },
  };
}

describe('LiveMeshLayer', () => {
  it('draws all pieces in one call from each side, where their submaps stand', () => {
    const { layer, say, submaps } = world();
    expect(layer.isThere).toBe(false);
    say({ kind: 'submapPoses', poses: [{ submap: 3, worldFromSubmap: pose(5), part: 0 }] });
    submaps.tick(1000);
    for (let x = 0; x < 500; ++x) say(piece(x, x === 0 ? 3 : 4));
    expect(layer.isThere).toBe(true);
    expect(layer.drawCalls).toBe(2);
    expect(layer.boxes()[0]).toEqual({ min_m: [5, 0, 0], max_m: [6, 1, 0], weight: 3 });
  });

  it('replaces a piece, also by one of another submap, and removes what is empty', () => {
    const { layer, say } = world();
    say(piece(0, 0));
    say(piece(1, 0));
    say(piece(0, 1));
    expect(layer.boxes()).toHaveLength(2);
    say(piece(0, 0, null));
    say(piece(1, 0, null));
    expect(layer.isThere).toBe(false);
    expect(layer.object.children).toEqual([]);
  });

  it('uses the room of what is gone, and keeps the corners of others', () => {
    const { layer, say } = world();
    for (let x = 0; x < 3; ++x) say(piece(x, 0));
    say(piece(1, 0, null));
    say(piece(3, 0));
    const { index } = (layer.object.children[0] as Mesh).geometry;
    // As they are drawn: three corners after the other, from the beginning on.
    const drawn = Array.from({ length: index!.count / 3 }, (_, t) =>
      [0, 1, 2].map((i) => index!.getX(3 * t + i)),
    ).filter(([a, b, c]) => a !== b && b !== c);
    expect(drawn).toEqual([
      [0, 1, 2],
      [48, 49, 50],
      [96, 97, 98],
    ]);
    expect(layer.drawCalls).toBe(2);
  });

  it('has confidences while each of its pieces has', () => {
    const { layer, say } = world();
    expect(layer.hasConfidences).toBe(false);
    say(piece(0, 0, seen(3)));
    expect(layer.hasConfidences).toBe(true);
    say(piece(1, 0));
    expect(layer.hasConfidences).toBe(false);
    say(piece(1, 0, seen(3)));
    expect(layer.hasConfidences).toBe(true);
  });

  it('counts the vertices that it holds by their confidences, and not those that are gone', () => {
    const { layer, say } = world();
    for (let x = 0; x < 3; ++x) say(piece(x, 0, seen(3)));
    say(piece(1, 0, seen(12)));
    say(piece(2, 0, null));
    const counts = layer.confidences();
    expect([counts[24], counts[96]]).toEqual([3, 3]);
    expect(counts.reduce((sum, count) => sum + count, 0)).toBe(6);
  });

  it('is painted with coverage, whatever its colour would be, and back', () => {
    const { layer, say } = world();
    say(piece(0, 0, seen(3)));
    const modes = (): unknown[] =>
      layer.object.children.map(
        (side) =>
          ((side as Mesh).material as ShaderMaterial).uniforms['colorMode']!.value as unknown,
      );
    layer.onOptions({ ...initialViewOptions, meshColor: 'normal', coverage: true });
    expect(modes()).toEqual([coverageMode, coverageMode]);
    layer.onOptions({ ...initialViewOptions, meshColor: 'normal' });
    expect(modes()).toEqual([2, 2]);
  });

  it('finds the triangle that was clicked on, from the front only', () => {
    const { layer, say, submaps } = world();
    say({ kind: 'submapPoses', poses: [{ submap: 3, worldFromSubmap: pose(5), part: 0 }] });
    submaps.tick(1000);
    say(piece(0, 3));
    const hit = layer.pick(new Ray(new Vector3(5.2, 0.2, 2), new Vector3(0, 0, -1)));
    expect(hit!.point_m.toArray().map((value) => Math.round(100 * value) / 100)).toEqual([
      5.2, 0.2, 0,
    ]);
    expect(hit!.normal.z).toBeCloseTo(1);
    expect(hit!.distance_m).toBeCloseTo(2);
    expect(layer.pick(new Ray(new Vector3(5.2, 0.2, -2), new Vector3(0, 0, 1)))).toBeNull();
    expect(layer.pick(new Ray(new Vector3(5.9, 0.9, 2), new Vector3(0, 0, -1)))).toBeNull();
  });
});
