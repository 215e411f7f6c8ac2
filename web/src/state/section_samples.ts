// What tests of the texts of sections look at, in every language.
import type { Model } from './cutting';

export const model: Model = {
  axes: { along: [1, 0, 0], up: [0, 1, 0] },
  low_m: [-2, -1, -3],
  high_m: [2, 2.5, 3],
  floor_m: -0.9,
};
export const line = {
  points: [
    [0, 0],
    [1, 0],
    [1, 1.5],
  ],
  closed: false,
} as const;
