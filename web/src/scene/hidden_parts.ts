// What of a model is not shown: what lies outside of the clip box, and what the boxes of edits have
// taken out. Shaders and clicks ask the same.
import { Matrix4, Vector3 } from 'three';
import { threeOf, type Axes } from '../state/axes';
import type { Box } from '../state/cutting';
import { mostEdits, type BoxEdit } from '../state/editing';

const slack_m = 2e-4; // what lies in a face is shown, as numbers are rounded
// All places are in the middle of this box.
const everything = new Matrix4().set(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1);

// Of a place inside of a box no coordinate is beyond one.
export interface HiddenUniforms {
  readonly clip: { readonly value: Matrix4 }; // boxFromScene
  // boxFromScene of the first `editCount` edits.
  readonly editBoxes: { readonly value: readonly Matrix4[] };
  // 1: what is inside of the box is shown, 0: what is outside of it.
  readonly editKeeps: { readonly value: number[] };
  readonly editCount: { value: number };
}

// isHidden(inScene) of vertex and fragment shaders.
export const hiddenShader = /* glsl */ `
uniform mat4 clip, editBoxes[${mostEdits}];
uniform float editKeeps[${mostEdits}];
uniform int editCount;

bool isHidden(vec4 inScene) {
  if (any(greaterThan(abs((clip * inScene).xyz), vec3(1.0)))) return true;
  for (int i = 0; i < editCount; ++i) {
    bool inside = all(lessThanEqual(abs((editBoxes[i] * inScene).xyz), vec3(1.0)));
    if (inside != (editKeeps[i] > 0.5)) return true;
  }
  return false;
}`;

function uniformsOf(): HiddenUniforms {
  return {
    clip: { value: everything.clone() },
    editBoxes: { value: Array.from({ length: mostEdits }, () => everything.clone()) },
    editKeeps: { value: Array.from({ length: mostEdits }, () => 1) },
    editCount: { value: 0 },
  };
}

export const nothingHidden: HiddenUniforms = uniformsOf();

export class HiddenParts {
  readonly uniforms = uniformsOf();
  private readonly clipFromWorld = everything.clone();
  private edits: readonly { readonly keeps: boolean; readonly boxFromWorld: Matrix4 }[] = [];

  // Null: nothing is clipped.
  setClip(axes: Axes | null, box: Box | null): void {
    this.clipFromWorld.copy(axes && box ? boxFromWorld(axes, box, slack_m) : everything);
  }

  setEdits(edits: readonly BoxEdit[]): void {
    this.edits = edits.map(({ kind, axes, ...box }) => {
      const keeps = kind === 'keep_inside';
      return { keeps, boxFromWorld: boxFromWorld(axes, box, keeps ? slack_m : -slack_m) };
    });
  }

  // Of the shaders; the world of the scan turns until up is up.
  place(sceneFromWorld: Matrix4): void {
    const worldFromScene = sceneFromWorld.clone().invert();
    const { clip, editBoxes, editKeeps, editCount } = this.uniforms;
    clip.value.multiplyMatrices(this.clipFromWorld, worldFromScene);
    for (const [i, { keeps, boxFromWorld: box }] of this.edits.entries()) {
      editBoxes.value[i]!.multiplyMatrices(box, worldFromScene);
      editKeeps.value[i] = keeps ? 1 : 0;
    }
    editCount.value = this.edits.length;
  }

  // In the world of the scan.
  shows(point_m: Vector3): boolean {
    return isInside(this.clipFromWorld, point_m) && this.isLeft(point_m);
  }

  // Whether the edits have left it.
  isLeft(point_m: Vector3): boolean {
    return this.edits.every(({ keeps, boxFromWorld: box }) => isInside(box, point_m) === keeps);
  }
}

function isInside(box: Matrix4, point_m: Vector3): boolean {
  const { x, y, z } = point_m.clone().applyMatrix4(box);
  return Math.max(Math.abs(x), Math.abs(y), Math.abs(z)) <= 1;
}

function boxFromWorld(axes: Axes, { low_m, high_m }: Box, grown_m: number): Matrix4 {
  const middle = new Vector3();
  const [x, y, z] = threeOf(axes).map((axis, k) => {
    middle.addScaledVector(new Vector3(...axis), (low_m[k]! + high_m[k]!) / 2);
    return new Vector3(...axis).multiplyScalar(
      Math.max(slack_m, (high_m[k]! - low_m[k]!) / 2 + grown_m),
    );
  }) as [Vector3, Vector3, Vector3];
  return new Matrix4().makeBasis(x, y, z).setPosition(middle).invert();
}
