import { Ray, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import type { ScanEvent } from '../connection/events';
import { HiddenParts } from './hidden_parts';
import { PointsLayer } from './points_layer';
import { frame, poses, running } from './played';
import { SampleCollector } from './samples';
import { SubmapsLayer } from './submaps_layer';

// `count` points in a row along x, from 1 on, that face -z.
const chunk = (submap: number, count = 1, x = 0): ScanEvent => ({
  kind: 'chunk',
  key: { submap, level: 0, x, y: 0, z: 0 },
  version: 1n,
  points:
    count === 0
      ? null
      : {
          count,
          positions_m: Float32Array.from({ length: 3 * count }, (_, i) =>
            i % 3 === 0 ? 1 + i / 300 : 0,
          ),
          colors: new Uint8Array(4 * count),
          normals: Int8Array.from({ length: 4 * count }, (_, i) => (i % 4 === 2 ? -127 : 0)),
          radii_m: new Float32Array(count).fill(0.02),
          min_m: [1, 0, 0],
          max_m: [1 + (count - 1) / 100, 0, 0],
        },
});

function play(...events: ScanEvent[]): {
  submaps: SubmapsLayer;
  points: PointsLayer;
  faded: (id: number) => boolean;
} {
  const submaps = new SubmapsLayer();
  const points = new PointsLayer(submaps);
  for (const event of events)
    for (const layer of [submaps, points]) (layer as PointsLayer).onEvent(event);
  return { submaps, points, faded: (id) => submaps.poses.isFaded(id) };
}

describe('PointsLayer', () => {
  it('puts a chunk into the frame of its submap, and takes it away', () => {
    const { points } = play(poses([0, 10]), chunk(1));
    expect(points.boxes()[0]!.min_m[0]).toBe(11);
    points.onEvent(chunk(1, 0));
    expect(points.boxes()).toEqual([]);
    expect(points.object.children).toEqual([]);
  });

  it('draws a thousand chunks of many submaps in one call, and uses room again', () => {
    const { points } = play(poses([0, 10, 20]));
    for (let round = 0; round < 3; ++round)
      for (let x = 0; x < 1000; ++x) points.onEvent(chunk(x % 3, 90 + ((x + round) % 20), x));
    expect(points.boxes()).toHaveLength(1000);
    expect(points.drawCalls).toBe(1);
  });

  it('counts the confidences of the points that it holds, and not of those that are gone', () => {
    const sure = (event: ScanEvent, confidence: number): ScanEvent => {
      if (event.kind === 'chunk') event.points?.colors.fill(8 * confidence);
      return event;
    };
    const { points } = play(poses([0, 10]), sure(chunk(0, 20), 3), sure(chunk(1, 40), 3));
    points.onEvent(sure(chunk(0, 30), 6));
    const held = (): number[] => [3, 6].map((confidence) => points.confidences()[8 * confidence]!);
    expect(held()).toEqual([40, 30]);
    points.onEvent(chunk(1, 0));
    expect(held()).toEqual([0, 30]);
  });

  it('fades the parts that the camera is not in, until they are joined', () => {
    const { submaps, points, faded } = play(
      running,
      poses([0, 10], [0, 1]),
      chunk(0),
      chunk(1),
      frame(1, 0),
    );
    expect([faded(0), faded(1)]).toEqual([true, false]);
    for (const layer of [submaps, points]) (layer as PointsLayer).onEvent(poses([0, 10], [0, 0]));
    expect([faded(0), faded(1)]).toEqual([false, false]);
  });

  it('finds the point that was clicked on, from the front only', () => {
    const { points } = play(poses([0, 10]), chunk(0), chunk(1, 50));
    const hit = points.pick(new Ray(new Vector3(11.2, 0.005, -2), new Vector3(0, 0, 1)));
    expect(hit!.point_m.x).toBeCloseTo(11.2, 1);
    expect(hit!.normal.z).toBeCloseTo(-1);
    expect(hit!.distance_m).toBeCloseTo(2);
    expect(points.pick(new Ray(new Vector3(11.2, 0, 2), new Vector3(0, 0, -1)))).toBeNull();
    expect(points.pick(new Ray(new Vector3(11.2, 0.1, -2), new Vector3(0, 0, 1)))).toBeNull();
  });

  it('does not find what is outside of the clip box', () => {
    const submaps = new SubmapsLayer();
    const hidden = new HiddenParts();
    const points = new PointsLayer(submaps, hidden);
    for (const event of [poses([0, 10]), chunk(0), chunk(1, 50)])
      for (const layer of [submaps, points]) (layer as PointsLayer).onEvent(event);
    const ray = new Ray(new Vector3(11.2, 0.005, -2), new Vector3(0, 0, 1));
    const axes = { along: [1, 0, 0], up: [0, -1, 0] } as const;
    hidden.setClip(axes, { low_m: [11, -1, -1], high_m: [12, 1, 1] });
    expect(points.pick(ray)).not.toBeNull();
    hidden.setClip(axes, { low_m: [11.5, -1, -1], high_m: [12, 1, 1] });
    expect(points.pick(ray)).toBeNull();
  });

  it('has large discs where every chunk has a point or two, and not where a scan begins', () => {
    const { points } = play(poses([0]));
    for (let x = 0; x < 2499; ++x) points.onEvent(chunk(0, 2, x));
    expect(points.least_m).toBe(0);
    for (let x = 2499; x < 2600; ++x) points.onEvent(chunk(0, 2, x));
    expect(points.least_m).toBeCloseTo(0.75 * Math.sqrt(0.1 / 2), 2);
    for (let x = 0; x < 2600; ++x) points.onEvent(chunk(0, 20, x));
    expect(points.least_m).toBe(0);
  });

  it('gives samples in the world, evenly', () => {
    const { points } = play(poses([0, 10]), chunk(1, 100));
    const samples = new SampleCollector(240_000); // one in ten
    points.sample(samples);
    const { count, positions_m, normals } = samples.take();
    expect(count).toBe(10);
    expect(positions_m[0]).toBe(11);
    expect(normals[2]).toBe(-1);
  });
});
