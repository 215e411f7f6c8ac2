import { describe, expect, it } from 'vitest';
import { faces } from '../state/cutting';
import { ClipLayer } from './clip_layer';

const axes = { along: [0, 0, 1], up: [0, -1, 0] } as const; // across: x
const box = { low_m: [1, 0, -2], high_m: [3, 2, 4] } as const;

describe('ClipLayer', () => {
  it('has a handle in the middle of each face while it is edited', () => {
    const layer = new ClipLayer();
    layer.show(axes, box, true);
    expect(layer.handleOf(faces[0]!)!.at_m.z).toBeCloseTo(1);
    expect(layer.handleOf(faces[1]!)!.at_m.z).toBeCloseTo(3);
    expect(layer.handleOf(faces[3]!)!.along.y).toBe(-1);
    layer.show(axes, box, false);
    expect(layer.handleOf(faces[0]!)).toBeNull();
  });
});
