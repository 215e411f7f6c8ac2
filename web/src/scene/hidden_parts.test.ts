import { Matrix4, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { HiddenParts } from './hidden_parts';

const axes = { along: [0, 0, 1], up: [0, -1, 0] } as const; // across: x
const box = { low_m: [1, 0, -2], high_m: [3, 2, 4] } as const;

// Of that coordinate along, up and across.
function at(along: number, up: number, beside: number): Vector3 {
  const across = new Vector3(0, 0, 1).cross(new Vector3(0, -1, 0));
  return new Vector3(0, -up, along).addScaledVector(across, beside);
}

describe('HiddenParts', () => {
  it('shows what is inside of the clip box, and everything without one', () => {
    const hidden = new HiddenParts();
    const far = new Vector3(900, 900, 900);
    expect(hidden.shows(far)).toBe(true);
    hidden.setClip(axes, box);
    expect(hidden.shows(far)).toBe(false);
    expect(hidden.shows(at(2, 1, 3.9))).toBe(true);
    expect(hidden.shows(at(2, 1, 4.1))).toBe(false);
    expect(hidden.shows(at(2, -0.1, 0))).toBe(false);
    expect(hidden.shows(at(0.9, 1, 0))).toBe(false);
    hidden.setClip(axes, null);
    expect(hidden.shows(far)).toBe(true);
  });

  it('hides what each edit has taken out', () => {
    const hidden = new HiddenParts();
    hidden.setEdits([
      { kind: 'keep_inside', axes, ...box },
      { kind: 'remove_inside', axes, low_m: [1, 0, -2], high_m: [3, 1, 4] },
    ]);
    expect(hidden.shows(at(2, 1.5, 0))).toBe(true);
    expect(hidden.shows(at(2, 0.5, 0))).toBe(false);
    expect(hidden.shows(at(2, 2.5, 0))).toBe(false);
    expect(hidden.shows(at(2, 1, 0))).toBe(true); // in the face of what was taken out
    hidden.setClip(axes, { low_m: [2.5, 0, -2], high_m: [3, 2, 4] });
    expect(hidden.shows(at(2, 1.5, 0))).toBe(false);
    expect(hidden.isLeft(at(2, 1.5, 0))).toBe(true);
    hidden.setEdits([]);
    hidden.setClip(null, null);
    expect(hidden.shows(at(2, 0.5, 0))).toBe(true);
  });

  it('tells shaders the same, however the world is turned', () => {
    const hidden = new HiddenParts();
    hidden.setClip(axes, box);
    hidden.setEdits([{ kind: 'remove_inside', axes, ...box }]);
    const sceneFromWorld = new Matrix4().makeRotationX(1);
    hidden.place(sceneFromWorld);
    const inScene = new Vector3(0, -2, 3).applyMatrix4(sceneFromWorld);
    const { clip, editBoxes, editKeeps, editCount } = hidden.uniforms;
    for (const matrix of [clip.value, editBoxes.value[0]!]) {
      const corner = inScene.clone().applyMatrix4(matrix);
      expect(corner.y).toBeCloseTo(1, 2);
      expect(corner.x).toBeCloseTo(1, 2);
    }
    expect([editKeeps.value[0], editCount.value]).toEqual([0, 1]);
  });
});
