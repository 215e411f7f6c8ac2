// The part of the image that no panel covers: on a phone, what somebody looks
// at belongs in its middle.
import type { PerspectiveCamera } from 'three';

export interface Edges {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

export interface FreePart {
  // From the middle of the image to the middle of the part, as a share of the
  // image's width, to the right.
  readonly x: number;
  readonly y: number; // and of its height, downwards
  readonly width: number; // shares of the image's
  readonly height: number;
}

export const wholeImage: FreePart = { x: 0, y: 0, width: 1, height: 1 };

const wide = 0.75; // of the image's width: such a panel covers a strip at the top or at the bottom
const high = 0.25; // of its height: one at a side
const least = 0.15; // of either: with less there is nothing to be seen, whatever is in the middle

// All in the same pixels.
export function freePart(image: Edges, panels: readonly Edges[]): FreePart {
  let { left: freeLeft, top: freeTop, right: freeRight, bottom: freeBottom } = image;
  const [width, height] = [image.right - image.left, image.bottom - image.top];
  for (const panel of panels) {
    const left = Math.max(panel.left, image.left);
    const right = Math.min(panel.right, image.right);
    const top = Math.max(panel.top, image.top);
    const bottom = Math.min(panel.bottom, image.bottom);
    if (right <= left || bottom <= top) continue;
    if (right - left >= wide * width) {
      if (top + bottom < image.top + image.bottom) freeTop = Math.max(freeTop, bottom);
      else freeBottom = Math.min(freeBottom, top);
    } else if (bottom - top >= high * height) {
      if (left + right < image.left + image.right) freeLeft = Math.max(freeLeft, right);
      else freeRight = Math.min(freeRight, left);
    }
  }
  const part = {
    x: (freeLeft + freeRight - image.left - image.right) / (2 * width),
    y: (freeTop + freeBottom - image.top - image.bottom) / (2 * height),
    width: (freeRight - freeLeft) / width,
    height: (freeBottom - freeTop) / height,
  };
  return part.width >= least && part.height >= least ? part : wholeImage;
}

// What the camera looks at comes to the middle of that part. Its rays and projections are those of
// the shifted image from then on.
export function showInMiddle(camera: PerspectiveCamera, { x, y }: Pick<FreePart, 'x' | 'y'>): void {
  const { aspect } = camera;
  if (x === 0 && y === 0) camera.clearViewOffset();
  else camera.setViewOffset(aspect, 1, -x * aspect, -y, aspect, 1);
}
