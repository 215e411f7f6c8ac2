// One thing to see in the scene. A new layer is one file and one row in scene.ts.
import type { Object3D, Vector3 } from 'three';
import type { ScanEvent } from '../connection/events';
import type { ViewOptions } from '../state/view_options';

// What all layers may need to draw at a size in metres or pixels.
export interface ViewSize {
  readonly width_px: number; // of the drawing buffer
  readonly height_px: number;
  readonly verticalFov_rad: number;
}

// What somebody has clicked on, in the world.
export interface Hit {
  readonly point_m: Vector3;
  readonly normal: Vector3; // looks at whoever clicked
  readonly distance_m: number;
}

export interface Layer {
  readonly object: Object3D;
  onEvent?(event: ScanEvent): void; // chunks only after the ledger took them
  onOptions?(options: ViewOptions): void;
  onResize?(size: ViewSize): void;
  tick?(elapsed_ms: number): boolean; // true while it still moves
  dispose(): void;
}
