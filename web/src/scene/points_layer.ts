// The reconstructed surface: one cloud per chunk in the group of its submap. A correction moves groups and touches no point.
import { Box3, BufferAttribute, BufferGeometry, Group, Points, Sphere, Vector3 } from 'three';
import type { ChunkKey, ChunkPoints, ScanEvent } from '../connection/events';
import { nameOf } from '../state/chunk_ledger';
import type { ViewOptions } from '../state/view_options';
import type { Box } from './framing';
import type { Layer, ViewSize } from './layer';
import { PointsMaterial } from './points_material';
import type { SubmapsLayer } from './submaps_layer';

interface Cloud {
  readonly points: Points<BufferGeometry, PointsMaterial>;
  readonly submap: number;
}

export class PointsLayer implements Layer {
  readonly object = new Group(); // empty: the clouds are in the groups of their submaps
  private readonly material = new PointsMaterial({ faded: false });
  private readonly apartMaterial = new PointsMaterial({ faded: true });
  private readonly clouds = new Map<string, Cloud>();
  private visible = true;

  constructor(private readonly submaps: SubmapsLayer) {}

  onEvent(event: ScanEvent): void {
    if (event.kind === 'chunk') this.replace(event.key, event.points);
    if (event.kind === 'frame' || event.kind === 'submapPoses' || event.kind === 'scanState') this.tellPartsApart();
  }

  onOptions(options: ViewOptions): void {
    for (const material of [this.material, this.apartMaterial]) material.show(options);
  }

  // Hidden clouds still have their boxes.
  setVisible(visible: boolean): void {
    this.visible = visible;
    for (const { points } of this.clouds.values()) points.visible = visible;
  }

  onResize(size: ViewSize): void {
    for (const material of [this.material, this.apartMaterial]) material.resize(size);
  }

  // World boxes of all chunks, for framing.
  boxes(): Box[] {
    const box = new Box3();
    return [...this.clouds.values()].map(({ points }) => {
      box.copy(points.geometry.boundingBox!).applyMatrix4(points.parent!.matrix);
      return { min_m: box.min.toArray(), max_m: box.max.toArray(), weight: points.geometry.getAttribute('position').count };
    });
  }

  dispose(): void {
    for (const { points } of this.clouds.values()) points.geometry.dispose();
    this.material.dispose();
    this.apartMaterial.dispose();
  }

  private replace(key: ChunkKey, points: ChunkPoints | null): void {
    const name = nameOf(key);
    const old = this.clouds.get(name);
    old?.points.removeFromParent();
    old?.points.geometry.dispose();
    this.clouds.delete(name);
    if (!points) return;
    const cloud = new Points(geometryOf(points), this.materialOf(key.submap));
    cloud.matrixAutoUpdate = false;
    cloud.visible = this.visible;
    this.clouds.set(name, { points: cloud, submap: key.submap });
    this.submaps.groupOf(key.submap).add(cloud);
  }

  private tellPartsApart(): void {
    for (const { points, submap } of this.clouds.values()) points.material = this.materialOf(submap);
  }

  private materialOf(submap: number): PointsMaterial {
    return this.submaps.isApart(submap) ? this.apartMaterial : this.material;
  }
}

function geometryOf(points: ChunkPoints): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(points.positions_m, 3));
  geometry.setAttribute('pointColor', new BufferAttribute(points.colors, 4, true));
  geometry.setAttribute('normal', new BufferAttribute(points.normals, 4, true));
  geometry.boundingBox = new Box3(new Vector3(...points.min_m), new Vector3(...points.max_m));
  geometry.boundingSphere = geometry.boundingBox.getBoundingSphere(new Sphere());
  return geometry;
}
