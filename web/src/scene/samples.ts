// Takes some points of a surface, evenly, to find out where up is.
import { Vector3, type Matrix4 } from 'three';
import type { SurfaceSamples } from './gravity';

const most_samples = 24_000;

export interface SamplePoint {
  readonly position_m: readonly [number, number, number];
  readonly normal: readonly [number, number, number];
}

export class SampleCollector {
  private readonly stride: number;
  private readonly positions_m: number[] = [];
  private readonly normals: number[] = [];
  private skip = 0; // points until the next one, over the ends of pieces

  // `total`: points that there will be, about.
  constructor(total: number) {
    this.stride = Math.max(1, total / most_samples);
  }

  add(count: number, worldFromPoints: Matrix4, at: (i: number) => SamplePoint): void {
    const vector = new Vector3();
    let i = this.skip;
    for (; i < count; i += this.stride) {
      const { position_m, normal } = at(Math.floor(i));
      if (normal[0] === 0 && normal[1] === 0 && normal[2] === 0) continue;
      this.positions_m.push(
        ...vector.fromArray(position_m).applyMatrix4(worldFromPoints).toArray(),
      );
      this.normals.push(...vector.fromArray(normal).transformDirection(worldFromPoints).toArray());
    }
    this.skip = i - count;
  }

  take(): SurfaceSamples {
    const count = this.positions_m.length / 3;
    const weights = new Float32Array(count).fill(1);
    return {
      count,
      positions_m: Float32Array.from(this.positions_m),
      normals: Float32Array.from(this.normals),
      weights,
    };
  }
}
