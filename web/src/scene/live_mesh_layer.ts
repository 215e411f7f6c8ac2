// The surface of a scan that runs: one mesh per piece in the group of the submap that it moves with, and the same once more for those who see
// it from behind.
import { Box3, BufferAttribute, BufferGeometry, Group, Mesh, type Object3D } from 'three';
import type { MeshCube, MeshPiece, ScanEvent } from '../connection/events';
import { nameOfCube } from '../state/chunk_ledger';
import { meshColors, shownMeshColor, type ViewOptions } from '../state/view_options';
import type { Box } from './framing';
import type { Layer } from './layer';
import { MeshMaterial } from './mesh_material';
import type { SampleCollector } from './samples';
import type { SubmapsLayer } from './submaps_layer';

interface Piece {
  readonly submap: number;
  readonly front: Mesh<BufferGeometry, MeshMaterial>;
  readonly back: Mesh<BufferGeometry, MeshMaterial>;
}

interface Sides {
  readonly front: MeshMaterial;
  readonly back: MeshMaterial;
}

const sides = (): Sides => ({
  front: new MeshMaterial({ back: false, map: null, color: 'srgb' }),
  back: new MeshMaterial({ back: true, map: null, color: 'srgb' }),
});

export class LiveMeshLayer implements Layer {
  readonly object = new Group(); // empty: the pieces are in the groups of their submaps
  private readonly near = sides();
  private readonly apart = sides(); // of a part of the map that the camera is not in
  private readonly pieces = new Map<string, Piece>();
  private visible = true;

  constructor(private readonly submaps: SubmapsLayer) {}

  get isThere(): boolean {
    return this.pieces.size > 0;
  }

  onEvent(event: ScanEvent): void {
    if (event.kind === 'meshChunk') this.replace(event.cube, event.submap, event.piece);
    if (event.kind === 'frame' || event.kind === 'submapPoses' || event.kind === 'scanState') this.tellPartsApart();
  }

  onOptions(options: ViewOptions): void {
    const look = { colorMode: meshColors.indexOf(shownMeshColor(options, false)), veil: options.hideBacks };
    for (const [{ front, back }, faded] of [
      [this.near, false],
      [this.apart, true],
    ] as const)
      for (const material of [front, back]) material.show({ ...look, faded });
  }

  // Hidden pieces still have their boxes.
  setVisible(visible: boolean): void {
    this.visible = visible;
    for (const { front, back } of this.pieces.values()) front.visible = back.visible = visible;
  }

  // World boxes of all pieces, for framing.
  boxes(): Box[] {
    const box = new Box3();
    return [...this.pieces.values()].map(({ front }) => {
      box.copy(front.geometry.boundingBox!).applyMatrix4(front.parent!.matrix);
      return { min_m: box.min.toArray(), max_m: box.max.toArray(), weight: front.geometry.getAttribute('position').count };
    });
  }

  // Some of the corners, evenly.
  sample(into: SampleCollector): void {
    for (const { front } of this.pieces.values()) {
      const [position, normal] = [front.geometry.getAttribute('position'), front.geometry.getAttribute('normal')];
      into.add(position.count, front.parent!.matrix, (i) => ({
        position_m: [position.getX(i), position.getY(i), position.getZ(i)],
        normal: [normal.getX(i), normal.getY(i), normal.getZ(i)],
      }));
    }
  }

  // What is seen from the front, to be clicked on; nothing while it is hidden.
  fronts(): Object3D[] {
    return this.visible ? [...this.pieces.values()].map(({ front }) => front) : [];
  }

  // Another surface takes over.
  clear(): void {
    for (const name of [...this.pieces.keys()]) this.remove(name);
  }

  dispose(): void {
    this.clear();
    for (const { front, back } of [this.near, this.apart]) {
      front.dispose();
      back.dispose();
    }
  }

  private remove(name: string): void {
    const old = this.pieces.get(name);
    old?.front.removeFromParent();
    old?.back.removeFromParent();
    old?.front.geometry.dispose();
    this.pieces.delete(name);
  }

  private replace(cube: MeshCube, submap: number, mesh: MeshPiece | null): void {
    const name = nameOfCube(cube);
    this.remove(name);
    if (!mesh) return;
    const geometry = geometryOf(mesh);
    const materials = this.materialsOf(submap);
    const piece = { submap, front: new Mesh(geometry, materials.front), back: new Mesh(geometry, materials.back) };
    for (const side of [piece.front, piece.back]) {
      side.matrixAutoUpdate = false;
      side.visible = this.visible;
      this.submaps.groupOf(submap).add(side);
    }
    piece.back.renderOrder = 1;
    this.pieces.set(name, piece);
  }

  private tellPartsApart(): void {
    for (const { front, back, submap } of this.pieces.values()) ({ front: front.material, back: back.material } = this.materialsOf(submap));
  }

  private materialsOf(submap: number): Sides {
    return this.submaps.isApart(submap) ? this.apart : this.near;
  }
}

function geometryOf(mesh: MeshPiece): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(mesh.index, 1));
  geometry.setAttribute('position', new BufferAttribute(mesh.positions_m, 3));
  geometry.setAttribute('normal', new BufferAttribute(mesh.normals, 4, true));
  geometry.setAttribute('color', new BufferAttribute(mesh.colors, 4, true));
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  return geometry;
}
