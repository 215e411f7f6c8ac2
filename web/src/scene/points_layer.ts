// The reconstructed surface as discs. Chunks of all submaps share a few buffers, and a correction
// moves submaps and touches no point.
import { Box3, Group, Vector3, type Ray } from 'three';
import type { ChunkKey, ChunkPoints, ScanEvent } from '../connection/events';
import { nameOf } from '../state/chunk_ledger';
import type { ViewOptions } from '../state/view_options';
import { HiddenParts } from './hidden_parts';
import type { Box } from './framing';
import type { Hit, Layer, ViewSize } from './layer';
import { PointBatch, type BatchRange } from './point_batch';
import { PointsMaterial } from './points_material';
import type { SampleCollector } from './samples';
import type { SubmapsLayer } from './submaps_layer';

const batch_points = 1 << 17; // 3.5 MB; what is larger has one of its own

// A chunk of few points does not know how far its neighbours are (spacing.ts): where all are like
// that, as of a street that was imported, the area of a surface that crosses a chunk tells it.
const sparse_points = 16; // a chunk, on average
const sparseFrom_points = 5_000; // fewer are the beginning of a scan
const crossing_m2 = 0.1; // a chunk of level 0
const covering = 0.75; // of the distance on a square grid; 0.71 would do

interface Cloud {
  readonly submap: number;
  readonly batch: PointBatch;
  readonly range: BatchRange;
  readonly box: Box3; // in the frame of its submap
}

export class PointsLayer implements Layer {
  readonly object = new Group();
  private readonly material: PointsMaterial;
  private readonly clouds = new Map<string, Cloud>();
  private readonly batches: PointBatch[] = [];
  private count = 0; // of all points
  private leastRadius_m = 0;

  constructor(
    private readonly submaps: SubmapsLayer,
    private readonly hidden = new HiddenParts(),
  ) {
    this.material = new PointsMaterial(submaps.poses.uniform, hidden.uniforms);
  }

  get drawCalls(): number {
    return this.batches.length;
  }

  onEvent(event: ScanEvent): void {
    if (event.kind === 'chunk') this.replace(event.key, event.points);
  }

  onOptions(options: ViewOptions): void {
    this.material.show(options);
  }

  // Hidden clouds still have their boxes.
  setVisible(visible: boolean): void {
    this.object.visible = visible;
  }

  onResize(size: ViewSize): void {
    this.material.resize(size);
  }

  // Of every disc.
  get least_m(): number {
    return this.leastRadius_m;
  }

  // World boxes of all chunks, for framing.
  boxes(): Box[] {
    const box = new Box3();
    return [...this.clouds.values()].map((cloud) => {
      box.copy(cloud.box).applyMatrix4(this.submaps.groupOf(cloud.submap).matrix);
      return { min_m: box.min.toArray(), max_m: box.max.toArray(), weight: cloud.range.count };
    });
  }

  // Some of the points, evenly.
  sample(into: SampleCollector): void {
    for (const { batch, range, submap } of this.clouds.values()) {
      const { matrix } = this.submaps.groupOf(submap);
      into.add(range.count, matrix, (i) => batch.at(range.start + i));
    }
  }

  // How many points there are of each confidence, which is an eighth of the index.
  confidences(): Uint32Array {
    const counts = new Uint32Array(256);
    for (const { batch, range } of this.clouds.values()) batch.countConfidences(range, counts);
    return counts;
  }

  // The nearest disc that the ray meets from the front; `ray` in the world. The normal is 0 where a
  // point has none: its disc faces whoever looks.
  pick(ray: Ray): Hit | null {
    let best: Hit | null = null;
    const [center, normal] = [new Vector3(), new Vector3()];
    const box = new Box3();
    for (const { batch, range, submap, box: own } of this.clouds.values()) {
      const { matrix } = this.submaps.groupOf(submap);
      if (
        !ray.intersectsBox(
          box
            .copy(own)
            .applyMatrix4(matrix)
            .expandByScalar(0.02 + this.leastRadius_m),
        )
      )
        continue;
      for (let i = range.start; i < range.start + range.count; ++i) {
        const at = batch.at(i);
        center.fromArray(at.position_m).applyMatrix4(matrix);
        const along_m = center.sub(ray.origin).dot(ray.direction);
        const radius_m = Math.max(at.radius_m, this.leastRadius_m);
        if (
          along_m <= 0 ||
          (best && along_m >= best.distance_m) ||
          center.lengthSq() - along_m * along_m > radius_m * radius_m
        )
          continue;
        normal.fromArray(at.normal).transformDirection(matrix);
        if (normal.dot(ray.direction) > 0) continue;
        const point_m = center.clone().add(ray.origin);
        if (this.hidden.shows(point_m))
          best = { point_m, normal: normal.clone(), distance_m: along_m };
      }
    }
    return best;
  }

  dispose(): void {
    for (const batch of this.batches) batch.dispose();
    this.material.dispose();
  }

  private replace(key: ChunkKey, points: ChunkPoints | null): void {
    const name = nameOf(key);
    const old = this.clouds.get(name);
    old?.batch.remove(old.range);
    this.clouds.delete(name);
    this.count += (points?.count ?? 0) - (old?.range.count ?? 0);
    if (points) {
      const [batch, range] = this.put(points, this.submaps.poses.rowOf(key.submap));
      this.clouds.set(name, {
        submap: key.submap,
        batch,
        range,
        box: new Box3(new Vector3(...points.min_m), new Vector3(...points.max_m)),
      });
    }
    if (old?.batch.isEmpty) this.drop(old.batch);
    this.enlarge(key.level);
  }

  private enlarge(level: number): void {
    const average = this.count / Math.max(1, this.clouds.size);
    const sparse = average < sparse_points && this.count >= sparseFrom_points;
    this.leastRadius_m = sparse ? covering * Math.sqrt(crossing_m2 / average) * 2 ** level : 0;
    this.material.enlarge(this.leastRadius_m);
  }

  private put(points: ChunkPoints, row: number): [PointBatch, BatchRange] {
    for (const batch of this.batches) {
      const range = batch.put(points, row);
      if (range) return [batch, range];
    }
    const batch = new PointBatch(Math.max(batch_points, points.count), this.material);
    this.batches.push(batch);
    this.object.add(batch.object);
    return [batch, batch.put(points, row)!];
  }

  private drop(batch: PointBatch): void {
    this.batches.splice(this.batches.indexOf(batch), 1);
    batch.object.removeFromParent();
    batch.dispose();
  }
}
