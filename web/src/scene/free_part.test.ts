import { PerspectiveCamera, Raycaster, Vector2, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { freePart, showInMiddle, wholeImage } from './free_part';

const phone = { left: 0, top: 0, right: 400, bottom: 800 };
const above = { left: 10, top: 60, right: 390, bottom: 300 };
const below = { left: 10, top: 700, right: 390, bottom: 790 };

describe('freePart', () => {
  it('is between what covers the top and what covers the bottom', () => {
    expect(freePart(phone, [above, below])).toEqual({ x: 0, y: 0.125, width: 1, height: 0.5 });
    expect(freePart(phone, [below])).toEqual({ x: 0, y: -0.0625, width: 1, height: 0.875 });
  });

  it('is beside what stands at a side', () => {
    const lying = { left: 0, top: 100, right: 800, bottom: 500 };
    const aside = { left: 0, top: 150, right: 400, bottom: 450 };
    expect(freePart(lying, [aside])).toEqual({ x: 0.25, y: 0, width: 0.5, height: 1 });
  });

  it('is all of the image where panels are small, beside it or everywhere', () => {
    expect(freePart(phone, [])).toEqual(wholeImage);
    expect(freePart(phone, [{ left: 10, top: 60, right: 200, bottom: 200 }])).toEqual(wholeImage);
    expect(freePart({ ...phone, top: 300 }, [{ ...above, bottom: 290 }])).toEqual(wholeImage);
    expect(freePart(phone, [{ ...above, bottom: 650 }, below])).toEqual(wholeImage);
  });
});

describe('showInMiddle', () => {
  it('shows what the camera looks at in the middle of the free part, where it is also hit', () => {
    const camera = new PerspectiveCamera(50, 0.5, 0.1, 100);
    showInMiddle(camera, freePart(phone, [above, below]));
    camera.updateMatrixWorld();
    expect(camera.aspect).toBe(0.5);
    const [x, y] = new Vector3(0, 0, -5).project(camera);
    expect(x).toBeCloseTo(0);
    expect((1 - y!) / 2).toBeCloseTo(500 / 800); // from the top: between 300 and 700
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2(0, y), camera);
    expect(caster.ray.direction.distanceTo(new Vector3(0, 0, -1))).toBeCloseTo(0);
  });

  it('changes nothing where all of the image is free', () => {
    const camera = new PerspectiveCamera(50, 0.5, 0.1, 100);
    const before = camera.projectionMatrix.toArray();
    showInMiddle(camera, wholeImage);
    expect(camera.projectionMatrix.toArray()).toEqual(before);
  });
});
