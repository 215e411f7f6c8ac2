// Where a plane cuts the surface: lines, in front of everything.
import { Group } from 'three';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
import type { Axes } from '../state/axes';
import type { Box, Plane } from '../state/cutting';
import { clippedTo, placeOf } from '../state/section';
import type { Layer } from './layer';

const color = 0xd6336c; // shows on a light ground and on a dark one
const width_px = 2.5;

export interface Cut {
  readonly plane: Plane;
  readonly axes: Axes;
  readonly clip: Box | null;
}

export class SectionLayer implements Layer {
  readonly object = new Group();
  private readonly lines = new LineSegments2(
    new LineSegmentsGeometry(),
    new LineMaterial({ color, linewidth: width_px, depthTest: false, transparent: true }),
  );

  constructor() {
    this.lines.renderOrder = 7;
    this.lines.frustumCulled = false;
    this.object.add(this.lines);
    this.object.visible = false;
  }

  // Segments of the surface in the plane (section.ts); null: none. Gives those that are drawn.
  show(segments: readonly number[], cut: Cut | null): readonly number[] {
    const shown = cut?.clip ? clippedTo(segments, cut.plane, cut.axes, cut.clip) : segments;
    this.object.visible = shown.length > 0;
    this.lines.geometry.dispose();
    this.lines.geometry = new LineSegmentsGeometry();
    if (cut && shown.length > 0) this.lines.geometry.setPositions(placesOf(shown, cut.plane));
    return shown;
  }

  dispose(): void {
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }
}

function placesOf(segments: readonly number[], plane: Plane): Float32Array {
  const places = new Float32Array((segments.length / 2) * 3);
  for (let i = 0; i < segments.length; i += 2)
    places.set(placeOf([segments[i]!, segments[i + 1]!], plane), (i / 2) * 3);
  return places;
}
