// Applies the clip box to points and surfaces, and computes the section of the surface.
import { Ray, Vector3 } from 'three';
import type { Axes, Triple } from '../state/axes';
import {
  faces,
  planeOf,
  type Cutting,
  type Face,
  type Model,
  type Plane,
  type Section,
} from '../state/cutting';
import { segmentsOf, type Surface } from '../state/section';
import type { ClipLayer } from './clip_layer';
import type { HiddenParts } from './hidden_parts';
import { wallAxes } from './heading';
import type { LiveMeshLayer } from './live_mesh_layer';
import type { MeshLayer } from './mesh_layer';
import { boundsAlong } from './model_bounds';
import type { PointsLayer } from './points_layer';
import { SampleCollector } from './samples';
import { SectionLayer } from './section_layer';

export type SurfaceKind = 'none' | 'growing' | 'finished';

// A squared sine: an axis this close to the line of sight cannot be dragged along.
const alongSight = 0.02;

interface Shown {
  readonly points: PointsLayer;
  readonly live: LiveMeshLayer;
  readonly mesh: MeshLayer;
  readonly clip: ClipLayer;
  readonly hidden: HiddenParts;
}

export class ModelCut {
  readonly section = new SectionLayer();
  private cutting: Cutting | null = null;
  private known: {
    readonly surfaces: readonly Surface[];
    readonly section: Section;
    readonly segments: number[];
  } | null = null;

  constructor(private readonly shown: Shown) {}

  get surface(): SurfaceKind {
    return this.shown.mesh.isThere ? 'finished' : this.shown.live.isThere ? 'growing' : 'none';
  }

  // Returns the bounds of the model along `axes`, or along the directions of its walls if
  // `axes` is null; null if the model is empty. `floor_m` is the height of the floor along
  // up, null if it is unknown.
  measure(axes: Axes | null, up: Triple, floor_m: number | null): Model | null {
    const { points, live, mesh } = this.shown;
    const boxes = [...points.boxes(), ...live.boxes()];
    const surfaces = mesh.surfaces();
    const known =
      axes ?? wallAxes(this.samples(boxes.reduce((sum, { weight }) => sum + weight, 0)), up);
    const box = boundsAlong(known, boxes, surfaces);
    return (
      box && {
        ...box,
        axes: known,
        floor_m: Math.max(box.low_m[1], Math.min(box.high_m[1], floor_m ?? box.low_m[1])),
      }
    );
  }

  // Shows this clip box and section. Returns the lines of the section in coordinates of its plane.
  show(cutting: Cutting): readonly number[] {
    const isSame =
      cutting.clip === this.cutting?.clip &&
      cutting.active === this.cutting.active &&
      cutting.axes === this.cutting.axes;
    this.cutting = cutting;
    if (!isSame) {
      this.shown.hidden.setClip(cutting.axes, cutting.clip);
      this.shown.clip.show(cutting.axes, cutting.clip, cutting.active);
    }
    return this.refresh();
  }

  // Computes the section again after the surface has changed.
  refresh(): readonly number[] {
    const { axes, section, clip } = this.cutting ?? { axes: null, section: null, clip: null };
    if (!axes || !section) return this.section.show([], null);
    const plane = planeOf(axes, section);
    return this.section.show(this.segments(section, plane), { plane, axes, clip });
  }

  // Returns the face whose handle is nearest on the screen, by `away_px`; null if
  // none is within `reach_px`.
  handleAt(away_px: (place: Triple) => number, reach_px: number): Face | null {
    let best: { readonly face: Face; readonly away: number } | null = null;
    for (const face of faces) {
      const handle = this.shown.clip.handleOf(face);
      const away = handle ? away_px(handle.at_m.toArray()) : Infinity;
      if (away <= reach_px && away < (best?.away ?? Infinity)) best = { face, away };
    }
    return best?.face ?? null;
  }

  // Returns the coordinate on the axis of a face where the ray passes closest to it; null if the
  // ray is nearly parallel to the axis.
  alongHandle(face: Face, ray: Ray): number | null {
    const handle = this.shown.clip.handleOf(face);
    if (!handle) return null;
    const between = new Vector3().subVectors(ray.origin, handle.at_m);
    const cosine = handle.along.dot(ray.direction);
    const spread = 1 - cosine * cosine;
    return spread < alongSight
      ? null
      : handle.at_m.dot(handle.along) +
          (between.dot(handle.along) - cosine * between.dot(ray.direction)) / spread;
  }

  // Returns the segments where the plane cuts the surface. They are kept while
  // only the clip box changes.
  private segments(section: Section, plane: Plane): number[] {
    const surfaces = this.surfaces();
    if (this.known?.surfaces === surfaces && this.known.section === section)
      return this.known.segments;
    const segments: number[] = [];
    for (const surface of surfaces)
      for (const value of segmentsOf(surface, plane)) segments.push(value);
    this.known = { surfaces, section, segments };
    return segments;
  }

  private surfaces(): readonly Surface[] {
    return this.shown.mesh.isThere ? this.shown.mesh.surfaces() : this.shown.live.surfaces();
  }

  private samples(total: number) {
    const { points, live, mesh } = this.shown;
    const vertices = mesh
      .surfaces()
      .reduce((sum, { positions_m }) => sum + positions_m.length / 3, 0);
    const samples = new SampleCollector(total + vertices);
    for (const layer of [points, live, mesh]) layer.sample(samples);
    return samples.take();
  }
}
