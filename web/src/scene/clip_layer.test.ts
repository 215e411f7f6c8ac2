import { Matrix4, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { faces } from '../state/cutting';
import { ClipLayer } from './clip_layer';

const axes = { along: [0, 0, 1], up: [0, -1, 0] } as const; // across: x
const box = { low_m: [1, 0, -2], high_m: [3, 2, 4] } as const;

describe('ClipLayer', () => {
  it('holds what is inside of the box, and everything without one', () => {
    const layer = new ClipLayer();
    const far = new Vector3(900, 900, 900);
    expect(layer.holds(far)).toBe(true);
    layer.show(axes, box, false);
    expect(layer.holds(far)).toBe(false);
    const across = new Vector3(0, 0, 1).cross(new Vector3(0, -1, 0));
    const at = (along: number, up: number, beside: number): Vector3 => new Vector3(0, -up, along).addScaledVector(across, beside);
    expect(layer.holds(at(2, 1, 3.9))).toBe(true);
    expect(layer.holds(at(2, 1, 4.1))).toBe(false);
    expect(layer.holds(at(2, -0.1, 0))).toBe(false);
    expect(layer.holds(at(0.9, 1, 0))).toBe(false);
    layer.show(axes, null, false);
    expect(layer.holds(far)).toBe(true);
  });

  it('tells shaders the same, however the world is turned', () => {
    const layer = new ClipLayer();
    layer.show(axes, box, true);
    const sceneFromWorld = new Matrix4().makeRotationX(1);
    layer.place(sceneFromWorld);
    const corner = new Vector3(0, -2, 3).applyMatrix4(sceneFromWorld).applyMatrix4(layer.uniform.value);
    expect(corner.y).toBeCloseTo(1);
    expect(corner.x).toBeCloseTo(1);
  });

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
