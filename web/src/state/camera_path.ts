// How long the way of a camera was, from trajectory.txt. Pure functions.

const step_m = 0.02; // shorter movements are trembling: they would make metres of a camera at rest
// From one frame to the next no camera is followed farther: the map was corrected, or the camera
// was found again elsewhere.
const farthestStep_m = 0.5;

export interface CameraPath {
  readonly length_m: number; // where the camera was followed
  readonly duration_s: number; // by the camera's clock
}

// Null when the file has no line. A frame in which the camera was lost repeats the line of the one
// before it: the way until it was found is not known.
export function pathOf(trajectory: string): CameraPath | null {
  let [length_m, first_s, last_s] = [0, NaN, NaN];
  // Where the step begins, and the line before.
  let [from, before]: (readonly number[] | null)[] = [null, null];
  let wasLost = false;
  for (const line of trajectory.split('\n')) {
    if (line === '' || line.startsWith('#')) continue;
    const numbers = line.split(' ').map(Number);
    if (numbers.length < 8 || !numbers.every(Number.isFinite)) continue;
    const at = numbers.slice(1);
    if (Number.isNaN(first_s)) first_s = numbers[0]!;
    last_s = numbers[0]!;
    const isLost = before !== null && at.every((value, i) => value === before![i]);
    if (!from || wasLost || distance_m(before!, at) > farthestStep_m) from = at;
    else if (!isLost && distance_m(from, at) >= step_m) {
      length_m += distance_m(from, at);
      from = at;
    }
    before = at;
    wasLost = isLost;
  }
  return before ? { length_m, duration_s: last_s - first_s } : null;
}

function distance_m(a: readonly number[], b: readonly number[]): number {
  return Math.hypot(a[0]! - b[0]!, a[1]! - b[1]!, a[2]! - b[2]!);
}
