import { Mesh, Vector3 } from 'three';
import { expect, test } from 'vitest';
import { MomentLayer } from './moment_layer';
import { at } from './played';

test('the camera stands at its pose, once its field of view is known', () => {
  const layer = new MomentLayer();
  layer.show({ worldFromCamera: at(3), image: null });
  expect(layer.object.visible).toBe(false);
  layer.onEvent({
    kind: 'welcome',
    title: '',
    camera: { width: 4, height: 2, fx: 2, fy: 2, cx: 1.5, cy: 0.5 },
  });
  layer.show({ worldFromCamera: { translation: [3, 0, 0], rotation: [0, 1, 0, 0] }, image: null });
  expect(layer.object.visible).toBe(true);
  layer.object.updateMatrixWorld();
  const plane = layer.object.children.find((child) => child instanceof Mesh)!;
  expect(plane.visible).toBe(false); // its image is on its way
  const corner = new Vector3()
    .fromBufferAttribute(plane.geometry.getAttribute('position') as never, 0)
    .applyMatrix4(layer.object.matrixWorld);
  expect(corner.x).toBeCloseTo(3.3); // left of the camera, which looks back
  expect(corner.z).toBeCloseTo(-0.3);
  layer.show(null);
  expect(layer.object.visible).toBe(false);
});
