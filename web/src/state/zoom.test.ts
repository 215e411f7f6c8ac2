import { describe, expect, it } from 'vitest';
import { wholePicture, zoomedBy, type Spot, type Zoom } from './zoom';

const size = { width_px: 300, height_px: 200 };
const inPicture = ({ scale, left_px, top_px }: Zoom, [x, y]: Spot): Spot => [
  (x - left_px) / scale,
  (y - top_px) / scale,
];

describe('zoomedBy', () => {
  it('keeps what is between the fingers there', () => {
    const once = zoomedBy(wholePicture, 3, [200, 50], [200, 50], size);
    expect(once.scale).toBe(3);
    expect(inPicture(once, [200, 50])).toEqual([200, 50]);
    const twice = zoomedBy(once, 2, [120, 90], [140, 80], size);
    const [x, y] = inPicture(twice, [140, 80]);
    const [expectedX, expectedY] = inPicture(once, [120, 90]);
    expect(x).toBeCloseTo(expectedX);
    expect(y).toBeCloseTo(expectedY);
  });

  it('never leaves a part of the frame empty', () => {
    const large = zoomedBy(wholePicture, 2, [0, 0], [0, 0], size);
    expect(zoomedBy(large, 1, [0, 0], [500, 500], size)).toEqual(large);
    expect(zoomedBy(large, 1, [0, 0], [-5000, -5000], size)).toEqual({
      scale: 2,
      left_px: -300,
      top_px: -200,
    });
    expect(zoomedBy(large, 0.01, [70, 80], [70, 80], size)).toEqual(wholePicture);
  });

  it('has an end', () => expect(zoomedBy(wholePicture, 1e6, [0, 0], [0, 0], size).scale).toBe(12));
});
