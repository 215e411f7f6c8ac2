import {
  BufferAttribute,
  BufferGeometry,
  Group,
  Mesh,
  MeshBasicMaterial,
  Texture,
  Vector3,
} from 'three';
import { describe, expect, it } from 'vitest';
import { initialViewOptions } from '../state/view_options';
import { MeshLayer } from './mesh_layer';
import type { MeshMaterial } from './mesh_material';

function gltf(map: Texture | null = null): Group {
  const geometry = new BufferGeometry();
  geometry.setAttribute(
    'position',
    new BufferAttribute(Float32Array.of(1, 2, 3, 2, 2, 3, 1, 3, 3), 3),
  );
  geometry.setAttribute(
    'color',
    new BufferAttribute(Uint8Array.of(255, 0, 0, 255, 0, 0, 255, 0, 0), 3, true),
  );
  const root = new Group();
  root.add(new Mesh(geometry, new MeshBasicMaterial({ map })));
  return root;
}

const materials = (layer: MeshLayer): MeshMaterial[] =>
  layer.object.children.map((child) => (child as Mesh).material as MeshMaterial);

describe('MeshLayer', () => {
  it('puts what has y up into the world, where y points down', () => {
    const layer = new MeshLayer();
    layer.replace(gltf());
    layer.object.updateMatrixWorld(true);
    const corner = new Vector3(1, 2, 3).applyMatrix4(layer.object.children[0]!.matrixWorld);
    expect(corner.toArray().map((value) => Math.round(1000 * value) / 1000)).toEqual([1, -2, -3]);
  });

  it('is seen when there is a mesh and the viewer wants it', () => {
    const layer = new MeshLayer();
    layer.onOptions(initialViewOptions);
    expect(layer.object.visible).toBe(false);
    layer.replace(gltf());
    expect(layer.object.visible).toBe(true);
    layer.onOptions({ ...initialViewOptions, show: 'points' });
    expect(layer.object.visible).toBe(false);
    layer.replace(null);
    layer.onOptions(initialViewOptions);
    expect(layer.object.visible).toBe(false);
  });

  it('has a dim back, as good as transparent for those who look inside', () => {
    const layer = new MeshLayer();
    layer.onOptions(initialViewOptions);
    layer.replace(gltf());
    const [front, back] = materials(layer);
    expect(front!.depthWrite).toBe(true);
    expect(back!.uniforms['veil']!.value).toBe(true);
    expect(back!.depthWrite).toBe(false);
    layer.onOptions({ ...initialViewOptions, hideBacks: false });
    expect(back!.depthWrite).toBe(true);
  });

  it('is lit where it has only colours, not where it has an image, unless somebody chooses', () => {
    const layer = new MeshLayer();
    layer.onOptions(initialViewOptions);
    layer.replace(gltf());
    expect(materials(layer)[0]!.uniforms['colorMode']!.value).toBe(0);
    layer.replace(gltf(new Texture()));
    expect(layer.isTextured).toBe(true);
    expect(materials(layer)[0]!.uniforms['colorMode']!.value).toBe(1);
    layer.onOptions({ ...initialViewOptions, meshColor: 'shaded' });
    expect(materials(layer)[0]!.uniforms['colorMode']!.value).toBe(0);
  });
});
