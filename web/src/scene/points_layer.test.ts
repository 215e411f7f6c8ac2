import type { Points } from 'three';
import { describe, expect, it } from 'vitest';
import type { ScanEvent } from '../connection/events';
import { PointsLayer } from './points_layer';
import type { PointsMaterial } from './points_material';
import { frame, poses, running } from './played';
import { SubmapsLayer } from './submaps_layer';

const chunk = (submap: number, empty = false): ScanEvent => ({
  kind: 'chunk',
  key: { submap, level: 0, x: 0, y: 0, z: 0 },
  version: 1n,
  points: empty
    ? null
    : { count: 1, positions_m: Float32Array.of(1, 0, 0), colors: new Uint8Array(4), normals: new Int8Array(4), min_m: [1, 0, 0], max_m: [1, 0, 0] },
});

function play(...events: ScanEvent[]): { submaps: SubmapsLayer; points: PointsLayer; faded: (id: number) => boolean } {
  const submaps = new SubmapsLayer();
  const points = new PointsLayer(submaps);
  for (const event of events) for (const layer of [submaps, points]) layer.onEvent(event);
  const cloudOf = (id: number): Points => submaps.groupOf(id).children[0] as Points;
  return { submaps, points, faded: (id) => (cloudOf(id).material as PointsMaterial).uniforms['faded']!.value as boolean };
}

describe('PointsLayer', () => {
  it('puts a chunk into the frame of its submap, and takes it away', () => {
    const { submaps, points } = play(poses([0, 10]), chunk(1));
    expect(points.boxes()[0]!.min_m[0]).toBe(11);
    points.onEvent(chunk(1, true));
    expect(points.boxes()).toEqual([]);
    expect(submaps.groupOf(1).children).toEqual([]);
  });

  it('fades the parts that the camera is not in, until they are joined', () => {
    const { submaps, points, faded } = play(running, poses([0, 10], [0, 1]), chunk(0), chunk(1), frame(1, 0));
    expect([faded(0), faded(1)]).toEqual([true, false]);
    for (const layer of [submaps, points]) layer.onEvent(poses([0, 10], [0, 0]));
    expect([faded(0), faded(1)]).toEqual([false, false]);
  });
});
