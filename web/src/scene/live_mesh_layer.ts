// The surface of a scan that runs, from both sides. Pieces of all submaps share a few buffers, and
// a correction moves submaps and touches none of them.
import { Box3, Group, Matrix4, Ray, Vector3 } from 'three';
import type { MeshCube, MeshPiece, ScanEvent } from '../connection/events';
import { nameOfCube } from '../state/chunk_ledger';
import type { Surface } from '../state/section';
import { meshColors, shownMeshColor, type ViewOptions } from '../state/view_options';
import { HiddenParts } from './hidden_parts';
import type { Box } from './framing';
import type { Hit, Layer } from './layer';
import { MeshBatch, type PieceRange } from './mesh_batch';
import { coverageMode, MeshMaterial } from './mesh_material';
import type { SampleCollector } from './samples';
import type { SubmapsLayer } from './submaps_layer';

const batch_vertices = 1 << 16; // 3 MB with their triangles; what is larger has one of its own

interface Piece {
  readonly submap: number;
  readonly batch: MeshBatch;
  readonly range: PieceRange;
  readonly box: Box3; // in the frame of its submap
  readonly hasConfidences: boolean;
}

export class LiveMeshLayer implements Layer {
  readonly object = new Group();
  private readonly materials: { readonly front: MeshMaterial; readonly back: MeshMaterial };
  private readonly pieces = new Map<string, Piece>();
  private readonly batches: MeshBatch[] = [];
  private withoutConfidences = 0; // pieces

  constructor(
    private readonly submaps: SubmapsLayer,
    private readonly hidden = new HiddenParts(),
  ) {
    const sideOf = (back: boolean): MeshMaterial =>
      new MeshMaterial({
        back,
        map: null,
        color: 'srgb',
        confidences: true,
        poses: submaps.poses.uniform,
        hidden: hidden.uniforms,
      });
    this.materials = { front: sideOf(false), back: sideOf(true) };
  }

  get isThere(): boolean {
    return this.pieces.size > 0;
  }

  // Coverage can be painted on it.
  get hasConfidences(): boolean {
    return this.isThere && this.withoutConfidences === 0;
  }

  get drawCalls(): number {
    return 2 * this.batches.length;
  }

  onEvent(event: ScanEvent): void {
    if (event.kind === 'meshChunk') this.replace(event.cube, event.submap, event.piece);
  }

  onOptions(options: ViewOptions): void {
    const colorMode = options.coverage
      ? coverageMode
      : meshColors.indexOf(shownMeshColor(options, false));
    const look = { colorMode, veil: options.hideBacks };
    this.materials.front.show(look);
    this.materials.back.show(look);
  }

  // Hidden pieces still have their boxes.
  setVisible(visible: boolean): void {
    this.object.visible = visible;
  }

  // World boxes of all pieces, for framing.
  boxes(): Box[] {
    const box = new Box3();
    return [...this.pieces.values()].map((piece) => {
      box.copy(piece.box).applyMatrix4(this.submaps.groupOf(piece.submap).matrix);
      return {
        min_m: box.min.toArray(),
        max_m: box.max.toArray(),
        weight: piece.range.vertexCount,
      };
    });
  }

  // Some of the corners, evenly.
  sample(into: SampleCollector): void {
    for (const { batch, range, submap } of this.pieces.values())
      into.add(range.vertexCount, this.submaps.groupOf(submap).matrix, (i) =>
        batch.vertexAt(range.vertices.start + i),
      );
  }

  // How many vertices there are of each confidence, which is an eighth of the index. There is about
  // one for each cell that the surface passes through, so shares of them are shares of its area;
  // the few between two pieces count in both.
  confidences(): Uint32Array {
    const counts = new Uint32Array(256);
    for (const { batch, range } of this.pieces.values()) batch.countConfidences(range, counts);
    return counts;
  }

  // The nearest triangle that the ray meets from the front; `ray` in the world.
  pick(ray: Ray): Hit | null {
    let best: Hit | null = null;
    const [own, box, submapFromWorld] = [new Ray(), new Box3(), new Matrix4()];
    const [a, b, c, point] = [new Vector3(), new Vector3(), new Vector3(), new Vector3()];
    for (const { batch, range, submap, box: within } of this.pieces.values()) {
      const { matrix } = this.submaps.groupOf(submap);
      if (!ray.intersectsBox(box.copy(within).applyMatrix4(matrix))) continue;
      own.copy(ray).applyMatrix4(submapFromWorld.copy(matrix).invert());
      for (let i = range.corners.start; i < range.corners.start + range.cornerCount; i += 3) {
        [a, b, c].forEach((corner, k) =>
          corner.fromArray(batch.vertexAt(batch.cornerAt(i + k)).position_m),
        );
        if (!own.intersectTriangle(a, b, c, true, point)) continue;
        const distance_m = point.distanceTo(own.origin);
        if (best && distance_m >= best.distance_m) continue;
        const point_m = point.clone().applyMatrix4(matrix);
        if (!this.hidden.shows(point_m)) continue;
        const normal = b.sub(a).cross(c.sub(a)).transformDirection(matrix);
        best = { point_m, normal: normal.clone(), distance_m };
      }
    }
    return best;
  }

  // In the world of the scan, as it stands now.
  surfaces(): Surface[] {
    const point = new Vector3();
    return [...this.pieces.values()].map(({ batch, range, submap }) => {
      const { matrix } = this.submaps.groupOf(submap);
      const positions_m = new Float32Array(3 * range.vertexCount);
      for (let i = 0; i < range.vertexCount; ++i)
        batch
          .placeAt(range.vertices.start + i, point)
          .applyMatrix4(matrix)
          .toArray(positions_m, 3 * i);
      return {
        positions_m,
        index: Uint32Array.from(
          { length: range.cornerCount },
          (_, i) => batch.cornerAt(range.corners.start + i) - range.vertices.start,
        ),
      };
    });
  }

  // Another surface takes over.
  clear(): void {
    for (const name of [...this.pieces.keys()]) this.remove(name);
  }

  dispose(): void {
    for (const batch of this.batches) batch.dispose();
    this.materials.front.dispose();
    this.materials.back.dispose();
  }

  private remove(name: string): void {
    const old = this.pieces.get(name);
    if (!old) return;
    this.pieces.delete(name);
    if (!old.hasConfidences) --this.withoutConfidences;
    old.batch.remove(old.range);
    if (!old.batch.isEmpty) return;
    this.batches.splice(this.batches.indexOf(old.batch), 1);
    this.object.remove(old.batch.front, old.batch.back);
    old.batch.dispose();
  }

  private replace(cube: MeshCube, submap: number, mesh: MeshPiece | null): void {
    const name = nameOfCube(cube);
    this.remove(name);
    if (!mesh) return;
    const [batch, range] = this.put(mesh, this.submaps.poses.rowOf(submap));
    const { hasConfidences } = mesh;
    this.pieces.set(name, { submap, batch, range, box: boxOf(mesh.positions_m), hasConfidences });
    if (!hasConfidences) ++this.withoutConfidences;
  }

  private put(mesh: MeshPiece, row: number): [MeshBatch, PieceRange] {
    for (const batch of this.batches) {
      const range = batch.put(mesh, row);
      if (range) return [batch, range];
    }
    const batch = new MeshBatch(batch_vertices, mesh, this.materials);
    this.batches.push(batch);
    this.object.add(batch.front, batch.back);
    return [batch, batch.put(mesh, row)!];
  }
}

function boxOf(positions_m: Float32Array): Box3 {
  const box = new Box3();
  const point = new Vector3();
  for (let i = 0; i < positions_m.length; i += 3)
    box.expandByPoint(point.fromArray(positions_m, i));
  return box;
}
