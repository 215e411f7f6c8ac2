// The surface of a finished scan: one mesh, and behind it the same once more for
// those who see it from behind.
import {
  Color,
  Group,
  Matrix4,
  Mesh,
  Vector3,
  type BufferGeometry,
  type Material,
  type Object3D,
  type Texture,
} from 'three';
import type { Surface } from '../state/section';
import { meshColors, shownMeshColor, type ViewOptions } from '../state/view_options';
import { nothingHidden, type HiddenUniforms } from './hidden_parts';
import type { Layer } from './layer';
import { MeshMaterial } from './mesh_material';
import type { SampleCollector } from './samples';

// glTF has y up, the world y down: half a turn about x.
const worldFromGltf = new Matrix4().makeRotationX(Math.PI);

export class MeshLayer implements Layer {
  readonly object = new Group();
  private materials: MeshMaterial[] = [];
  private options: ViewOptions | null = null;
  private textured = false;
  private inWorld: Surface[] | null = null;

  constructor(private readonly hidden: HiddenUniforms = nothingHidden) {
    this.object.matrixAutoUpdate = false;
    this.object.matrix.copy(worldFromGltf);
    this.object.visible = false;
  }

  get isThere(): boolean {
    return this.materials.length > 0;
  }

  get isTextured(): boolean {
    return this.textured;
  }

  // What is seen from the front, to be clicked on.
  fronts(): Mesh<BufferGeometry>[] {
    return this.object.children.filter((side) => side.renderOrder === 0) as Mesh<BufferGeometry>[];
  }

  // Returns the triangles in the world frame of the scan. They are copied once for each mesh.
  surfaces(): readonly Surface[] {
    this.inWorld ??= this.fronts().map(({ geometry, matrix }) =>
      surfaceOf(geometry, new Matrix4().multiplyMatrices(worldFromGltf, matrix)),
    );
    return this.inWorld;
  }

  // Adds an even sample of the vertices with their normals.
  sample(into: SampleCollector): void {
    for (const { geometry, matrix } of this.fronts()) {
      const [positions, normals] = [
        geometry.getAttribute('position'),
        geometry.getAttribute('normal'),
      ];
      into.add(positions.count, new Matrix4().multiplyMatrices(worldFromGltf, matrix), (i) => ({
        position_m: [positions.getX(i), positions.getY(i), positions.getZ(i)],
        normal: [normals.getX(i), normals.getY(i), normals.getZ(i)],
      }));
    }
  }

  // Instead of the one before; null: none. What it holds is disposed of here.
  replace(root: Object3D | null): void {
    this.clear();
    root?.updateMatrixWorld(true);
    root?.traverse((object) => {
      if (object instanceof Mesh) this.add(object as Mesh<BufferGeometry>);
    });
    this.show();
  }

  onOptions(options: ViewOptions): void {
    this.options = options;
    this.show();
  }

  dispose(): void {
    this.clear();
  }

  private add(mesh: Mesh<BufferGeometry>): void {
    const { geometry } = mesh;
    const map = mapOf(mesh.material);
    if (!geometry.hasAttribute('normal')) geometry.computeVertexNormals();
    this.textured ||= map !== null;
    for (const back of [false, true]) {
      const material = new MeshMaterial({
        back,
        map,
        hidden: this.hidden,
        tint: colorOf(mesh.material),
        color: geometry.hasAttribute('color') ? 'linear' : 'none',
      });
      const side = new Mesh(geometry, material);
      side.matrixAutoUpdate = false;
      side.matrix.copy(mesh.matrixWorld);
      side.renderOrder = back ? 1 : 0;
      this.materials.push(material);
      this.object.add(side);
    }
  }

  private show(): void {
    if (!this.options) return;
    this.object.visible = this.isThere && this.options.show === 'surface' && !this.options.coverage;
    const look = {
      colorMode: meshColors.indexOf(shownMeshColor(this.options, this.textured)),
      veil: this.options.hideBacks,
    };
    for (const material of this.materials) material.show(look);
  }

  private clear(): void {
    for (const child of this.object.children) (child as Mesh<BufferGeometry>).geometry.dispose();
    for (const material of this.materials) {
      (material.uniforms['map']!.value as Texture | null)?.dispose();
      material.dispose();
    }
    this.object.clear();
    this.materials = [];
    this.textured = false;
    this.inWorld = null;
  }
}

function surfaceOf(geometry: BufferGeometry, worldFromMesh: Matrix4): Surface {
  const positions = geometry.getAttribute('position');
  const positions_m = new Float32Array(3 * positions.count);
  const point = new Vector3();
  for (let i = 0; i < positions.count; ++i)
    point
      .fromBufferAttribute(positions, i)
      .applyMatrix4(worldFromMesh)
      .toArray(positions_m, 3 * i);
  return {
    positions_m,
    index: geometry.index?.array ?? Uint32Array.from({ length: positions.count }, (_, i) => i),
  };
}

function mapOf(material: Material | Material[]): Texture | null {
  const one = Array.isArray(material) ? material[0] : material;
  return one && 'map' in one ? (one.map as Texture | null) : null;
}

// What the material of a glTF multiplies everything with.
function colorOf(material: Material | Material[]): Color {
  const one = Array.isArray(material) ? material[0] : material;
  return one && 'color' in one && one.color instanceof Color ? one.color : new Color(1, 1, 1);
}

export function trianglesIn(root: Object3D): number {
  let triangles = 0;
  root.traverse((object) => {
    if (object instanceof Mesh)
      triangles +=
        (object.geometry.index?.count ?? object.geometry.getAttribute('position').count) / 3;
  });
  return triangles;
}
