// A quiet floor: one line a metre, fading away from the middle of the scan. Hidden until the
// floor's height is known.
import {
  BufferAttribute,
  BufferGeometry,
  LineBasicMaterial,
  LineSegments,
  type Color,
} from 'three';
import type { Framing } from './framing';
import type { Layer } from './layer';

const halfExtent_m = 12;

export class GridLayer implements Layer {
  readonly object: LineSegments<BufferGeometry, LineBasicMaterial>;

  constructor() {
    this.object = new LineSegments(
      gridGeometry(),
      new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false }),
    );
    this.object.visible = false;
    this.object.renderOrder = -1;
  }

  paint(color: Color): void {
    this.object.material.color.copy(color);
  }

  // On whole metres, so that the lines stay put while the scan grows. A little below the floor,
  // which it would flicker in.
  placeUnder(framing: Framing): void {
    this.object.position.set(
      Math.round(framing.center_m[0]),
      framing.floor_y_m + 0.01,
      Math.round(framing.center_m[2]),
    );
    this.object.visible = true;
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}

function gridGeometry(): BufferGeometry {
  const positions: number[] = [];
  const colors: number[] = [];
  const vertex = (x: number, z: number): void => {
    positions.push(x, 0, z);
    const strength = Math.max(0, 1 - Math.hypot(x, z) / halfExtent_m);
    colors.push(1, 1, 1, strength * strength);
  };
  for (let line = -halfExtent_m; line <= halfExtent_m; ++line) {
    for (let step = -halfExtent_m; step < halfExtent_m; ++step) {
      vertex(line, step);
      vertex(line, step + 1);
      vertex(step, line);
      vertex(step + 1, line);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(Float32Array.from(positions), 3));
  geometry.setAttribute('color', new BufferAttribute(Float32Array.from(colors), 4));
  return geometry;
}
