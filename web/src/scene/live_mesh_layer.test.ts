import { Mesh, type Object3D } from 'three';
import { describe, expect, it } from 'vitest';
import type { FrameEvent, MeshCube, MeshPiece, Pose, ScanEvent } from '../connection/events';
import { initialViewOptions } from '../state/view_options';
import { LiveMeshLayer } from './live_mesh_layer';
import type { MeshMaterial } from './mesh_material';
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
  };
}

const piece = (x: number, submap: number, mesh: MeshPiece | null = triangle()): ScanEvent => ({ kind: 'meshChunk', cube: cube(x), version: 1n, submap, piece: mesh });

function world(): { submaps: SubmapsLayer; layer: LiveMeshLayer; meshesOf: (submap: number) => Mesh[]; say: (event: ScanEvent) => void } {
  const submaps = new SubmapsLayer();
  const layer = new LiveMeshLayer(submaps);
  layer.onOptions(initialViewOptions);
  return {
    submaps,
    layer,
    meshesOf: (submap) => submaps.groupOf(submap).children.filter((child: Object3D): child is Mesh => child instanceof Mesh),
    say: (event) => {
      submaps.onEvent(event);
      layer.onEvent(event);
    },
  };
}

describe('LiveMeshLayer', () => {
  it('draws each piece from both sides, in the submap that it moves with', () => {
    const { layer, meshesOf, say, submaps } = world();
    expect(layer.isThere).toBe(false);
    say({ kind: 'submapPoses', poses: [{ submap: 3, worldFromSubmap: pose(5), part: 0 }] });
    submaps.tick(1000);
    say(piece(0, 3));
    expect(layer.isThere).toBe(true);
    expect(meshesOf(3)).toHaveLength(2);
    expect(layer.boxes()).toEqual([{ min_m: [5, 0, 0], max_m: [6, 1, 0], weight: 3 }]);
  });

  it('replaces a piece, also by one of another submap, and removes what is empty', () => {
    const { layer, meshesOf, say } = world();
    say(piece(0, 0));
    say(piece(1, 0));
    say(piece(0, 1));
    expect(meshesOf(0)).toHaveLength(2);
    expect(meshesOf(1)).toHaveLength(2);
    say(piece(0, 0, null));
    say(piece(1, 0, null));
    expect(layer.isThere).toBe(false);
    expect([...meshesOf(0), ...meshesOf(1)]).toHaveLength(0);
  });

  it('hides new pieces, too, while points are shown', () => {
    const { layer, meshesOf, say } = world();
    say(piece(0, 0));
    layer.setVisible(false);
    say(piece(1, 0));
    expect(meshesOf(0).every((mesh) => !mesh.visible)).toBe(true);
    layer.setVisible(true);
    expect(meshesOf(0).every((mesh) => mesh.visible)).toBe(true);
  });

  it('fades what is of another part than the camera', () => {
    const { meshesOf, say } = world();
    const faded = (submap: number): boolean[] => meshesOf(submap).map((mesh) => (mesh.material as MeshMaterial).uniforms['faded']!.value as boolean);
    say({ kind: 'scanState', phase: 'running', words: '', received: 1, processed: 1, dropped: 0, keyframes: 0, loops: 0 });
    say({
      kind: 'submapPoses',
      poses: [
        { submap: 0, worldFromSubmap: pose(0), part: 0 },
        { submap: 1, worldFromSubmap: pose(1), part: 1 },
      ],
    });
    say(piece(0, 0));
    say(piece(1, 1));
    say({ kind: 'frame', inSubmap: { submap: 1, submapFromCamera: pose(0) } } as FrameEvent);
    expect(faded(0)).toEqual([true, true]);
    expect(faded(1)).toEqual([false, false]);
  });
});
