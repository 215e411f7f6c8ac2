// The reconstructed surface: a group per submap, whose matrix is the submap's pose, with one cloud per chunk. A correction moves groups and touches no point.
import { Box3, BufferAttribute, BufferGeometry, Group, Points, Sphere, Vector3 } from 'three';
import type { ChunkKey, ChunkPoints, Pose, ScanEvent } from '../connection/events';
import { nameOf } from '../state/chunk_ledger';
import type { ViewOptions } from '../state/view_options';
import type { Box } from './framing';
import type { Layer, ViewSize } from './layer';
import { GlidingPose } from './motion';
import { PointsMaterial } from './points_material';

const correction_ms = 300;

interface Submap {
  readonly group: Group;
  readonly worldFromSubmap: GlidingPose;
}

export class PointsLayer implements Layer {
  readonly object = new Group();
  private readonly material = new PointsMaterial();
  private readonly submaps = new Map<number, Submap>();
  private readonly clouds = new Map<string, Points>();

  onEvent(event: ScanEvent): void {
    if (event.kind === 'chunk') this.replace(event.key, event.points);
    if (event.kind === 'submapPoses') for (const pose of event.poses) this.move(pose.submap, pose.worldFromSubmap);
  }

  onOptions(options: ViewOptions): void {
    this.material.show(options);
  }

  onResize(size: ViewSize): void {
    this.material.resize(size);
  }

  tick(elapsed_ms: number): boolean {
    let moving = false;
    for (const submap of this.submaps.values()) {
      if (!submap.worldFromSubmap.tick(elapsed_ms)) continue;
      place(submap);
      moving = true;
    }
    return moving;
  }

  // World boxes of all chunks, for framing.
  boxes(): Box[] {
    const box = new Box3();
    return [...this.clouds.values()].map((cloud) => {
      box.copy(cloud.geometry.boundingBox!).applyMatrix4(cloud.parent!.matrix);
      return { min_m: box.min.toArray(), max_m: box.max.toArray(), weight: cloud.geometry.getAttribute('position').count };
    });
  }

  dispose(): void {
    for (const cloud of this.clouds.values()) cloud.geometry.dispose();
    this.material.dispose();
  }

  private replace(key: ChunkKey, points: ChunkPoints | null): void {
    const name = nameOf(key);
    const old = this.clouds.get(name);
    old?.removeFromParent();
    old?.geometry.dispose();
    this.clouds.delete(name);
    if (!points) return;
    const cloud = new Points(geometryOf(points), this.material);
    cloud.matrixAutoUpdate = false;
    this.clouds.set(name, cloud);
    this.submap(key.submap).group.add(cloud);
  }

  private move(id: number, pose: Pose): void {
    const submap = this.submap(id);
    submap.worldFromSubmap.moveTo(pose);
    place(submap);
  }

  // A submap without a pose yet stands where the world begins, as the first one does.
  private submap(id: number): Submap {
    let submap = this.submaps.get(id);
    if (!submap) {
      submap = { group: new Group(), worldFromSubmap: new GlidingPose(correction_ms) };
      submap.group.matrixAutoUpdate = false;
      this.submaps.set(id, submap);
      this.object.add(submap.group);
    }
    return submap;
  }
}

function place(submap: Submap): void {
  submap.worldFromSubmap.matrix(submap.group.matrix);
  submap.group.matrixWorldNeedsUpdate = true;
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
