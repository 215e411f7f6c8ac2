// How a picture is enlarged within its frame, which it always fills. Pixels are those of the frame,
// from its upper left corner.

export interface Zoom {
  readonly scale: number; // 1: all of it is seen
  readonly left_px: number; // of the enlarged picture
  readonly top_px: number;
}

export interface Size {
  readonly width_px: number;
  readonly height_px: number;
}

export type Spot = readonly [number, number]; // to the right, and down

export const wholePicture: Zoom = { scale: 1, left_px: 0, top_px: 0 };

const largest = 12;

// What was at `from` comes to `to`, and everything is `by` times as large.
export function zoomedBy(
  zoom: Zoom,
  by: number,
  from: Spot,
  to: Spot,
  { width_px, height_px }: Size,
): Zoom {
  const scale = Math.min(largest, Math.max(1, zoom.scale * by));
  const grown = scale / zoom.scale;
  return {
    scale,
    left_px: within(width_px * (1 - scale), to[0] - grown * (from[0] - zoom.left_px)),
    top_px: within(height_px * (1 - scale), to[1] - grown * (from[1] - zoom.top_px)),
  };
}

const perKey = 1.5;
const keyStep = 1 / 8; // of the frame
const zooming: ReadonlyMap<string, number> = new Map([
  ['+', perKey],
  ['=', perKey], // the same key without shift
  ['-', 1 / perKey],
]);
const moving: ReadonlyMap<string, Spot> = new Map<string, Spot>([
  ['ArrowLeft', [1, 0]],
  ['ArrowRight', [-1, 0]],
  ['ArrowUp', [0, 1]],
  ['ArrowDown', [0, -1]],
]);

// Null: the key is for something else, also an arrow while all of the picture is seen.
export function zoomedByKey(zoom: Zoom, key: string, size: Size): Zoom | null {
  if (key === '0' || key === 'Home') return wholePicture;
  const middle: Spot = [size.width_px / 2, size.height_px / 2];
  const by = zooming.get(key);
  if (by !== undefined) return zoomedBy(zoom, by, middle, middle, size);
  const way = moving.get(key);
  if (!way || zoom.scale === 1) return null;
  const to: Spot = [
    middle[0] + way[0] * keyStep * size.width_px,
    middle[1] + way[1] * keyStep * size.height_px,
  ];
  return zoomedBy(zoom, 1, middle, to, size);
}

function within(least_px: number, at_px: number): number {
  return Math.min(0, Math.max(least_px, at_px));
}
