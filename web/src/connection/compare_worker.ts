// The Web Worker that reads the points of a comparison: the page goes on meanwhile.
/// <reference lib="webworker" />
import { readComparedPoints, type ComparedPoints } from './compared_points';

declare const self: DedicatedWorkerGlobalScope;

export type CompareAnswer = { readonly points: ComparedPoints } | { readonly message: string };

self.onmessage = ({ data }: MessageEvent<ArrayBuffer>) => {
  try {
    const points = readComparedPoints(data);
    const buffers = points.chunks.flatMap(
      ({ points: { positions_m, colors, normals, radii_m }, states, distances_m }) =>
        [positions_m, colors, normals, radii_m, states, distances_m].map(
          ({ buffer }) => buffer as ArrayBuffer,
        ),
    );
    self.postMessage({ points } satisfies CompareAnswer, buffers);
  } catch (error) {
    self.postMessage({ message: (error as Error).message } satisfies CompareAnswer);
  }
};
