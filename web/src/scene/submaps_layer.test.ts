import { Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { frame, poses, running } from './played';
import { SubmapsLayer } from './submaps_layer';

const xOf = (submaps: SubmapsLayer, id: number): number =>
  new Vector3().applyMatrix4(submaps.groupOf(id).matrix).x;

describe('SubmapsLayer', () => {
  it('places a new submap at once and lets a corrected one glide', () => {
    const submaps = new SubmapsLayer();
    submaps.onEvent(poses([0, 2]));
    expect(xOf(submaps, 1)).toBe(2);
    const before = submaps.version;
    submaps.onEvent(poses([0, 3]));
    expect(submaps.tick(150)).toBe(true);
    expect(xOf(submaps, 1)).toBeCloseTo(2.5);
    expect(submaps.version).toBeGreaterThan(before);
    submaps.tick(1000);
    expect(xOf(submaps, 1)).toBe(3);
    expect(submaps.tick(10)).toBe(false);
  });

  it('does not move for poses that it has', () => {
    const submaps = new SubmapsLayer();
    submaps.onEvent(poses([0, 2]));
    submaps.onEvent(poses([0, 2]));
    expect(submaps.tick(10)).toBe(false);
  });

  it('tells the parts apart from the one that the camera is in, while the scan runs', () => {
    const submaps = new SubmapsLayer();
    submaps.onEvent(poses([0, 1, 2], [0, 0, 1]));
    submaps.onEvent(frame(2, 0));
    expect(submaps.isApart(0)).toBe(false); // nobody said that it runs
    submaps.onEvent(running);
    expect([0, 1, 2].map((id) => submaps.isApart(id))).toEqual([true, true, false]);
    submaps.onEvent(poses([0, 1, 2], [0, 0, 0]));
    expect(submaps.isApart(0)).toBe(false);
    submaps.onEvent(poses([0, 1, 2], [0, 0, 1]));
    submaps.onEvent(frame(0, 0, { inSubmap: null }));
    expect(submaps.isApart(2)).toBe(false); // an older server does not say where the camera is
  });
});
