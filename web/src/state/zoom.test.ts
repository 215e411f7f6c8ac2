import { describe, expect, it } from 'vitest';
import { wholePicture, zoomedBy, zoomedByKey, type Spot, type Zoom } from './zoom';

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

describe('zoomedByKey', () => {
  const pressed = (...keys: string[]): Zoom =>
    keys.reduce((zoom, key) => zoomedByKey(zoom, key, size) ?? zoom, wholePicture);

  it('enlarges around the middle, and goes back the same way', () => {
    const once = pressed('+');
    expect(once.scale).toBe(1.5);
    expect(inPicture(once, [150, 100])).toEqual([150, 100]);
    expect(pressed('=')).toEqual(once);
    expect(pressed('+', '-')).toEqual(wholePicture);
    expect(pressed('-')).toEqual(wholePicture);
  });

  it('moves to what is on the side of the arrow, as far as there is something', () => {
    const [x, y] = inPicture(pressed('+', '+'), [150, 100]);
    const [right] = inPicture(pressed('+', '+', 'ArrowRight'), [150, 100]);
    expect(right).toBeGreaterThan(x);
    const [, below] = inPicture(pressed('+', '+', 'ArrowDown'), [150, 100]);
    expect(below).toBeGreaterThan(y);
    expect(pressed('+', '+', 'ArrowRight', 'ArrowLeft')).toEqual(pressed('+', '+'));
    expect(pressed('+', '+', 'ArrowDown', 'ArrowUp')).toEqual(pressed('+', '+'));
    const far = Array.from({ length: 20 }, () => 'ArrowLeft');
    expect(pressed('+', ...far).left_px).toBe(0);
  });

  it('shows all of it again, and leaves other keys to others', () => {
    for (const key of ['0', 'Home'])
      expect(pressed('+', '+', 'ArrowUp', key)).toEqual(wholePicture);
    for (const key of ['a', 'Escape', 'Tab', 'constructor', 'ArrowLeft'])
      expect(zoomedByKey(wholePicture, key, size)).toBeNull();
  });
});
