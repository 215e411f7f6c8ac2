// What is drawn of a measurement: lines, a translucent surface and where its text stands, in the
// world of the scan. Pure.
import { ShapeUtils, Vector2, Vector3 } from 'three';
import type { Measured, Place } from '../connection/measurements';

const patch_m = 0.15; // half a side of the square that stands for a plane

export interface MeasureShape {
  readonly lines: readonly Place[]; // two a line
  readonly triangles: readonly Place[]; // three a triangle
  readonly ends: readonly Place[];
  readonly labelPlace: Place; // where its text stands
}

export function shapeOf({ kind, points, normals, up }: Measured): MeasureShape {
  const [first, second] = points.map(vector) as [Vector3, Vector3];
  const straight = {
    lines: placesOf([first, second]),
    triangles: [],
    ends: points,
    labelPlace: middleOf(first, second),
  };
  switch (kind) {
    case 'distance':
      return straight;
    case 'plane': {
      const normal = vector(normals[1]!);
      const foot = first.clone().addScaledVector(normal, normal.dot(second.clone().sub(first)));
      return {
        ...straight,
        lines: placesOf([first, foot, foot, second]),
        triangles: patchAt(second, normal),
        labelPlace: middleOf(first, foot),
      };
    }
    case 'height': {
      const along = vector(up!);
      const corner = first.clone().addScaledVector(along, along.dot(second.clone().sub(first)));
      return {
        ...straight,
        lines: placesOf([first, corner, corner, second]),
        labelPlace: middleOf(first, corner),
      };
    }
    case 'angle':
      return {
        ...straight,
        triangles: [
          ...patchAt(first, vector(normals[0]!)),
          ...patchAt(second, vector(normals[1]!)),
        ],
      };
    case 'area':
      return outlineOf(points);
  }
}

// Through what was chosen so far.
export function linesThrough(points: readonly Place[]): Place[] {
  return points.slice(1).flatMap((point, i) => [points[i]!, point]);
}

function outlineOf(points: readonly Place[]): MeasureShape {
  const corners = points.map(vector);
  const middle = corners
    .reduce((sum, corner) => sum.add(corner), new Vector3())
    .divideScalar(corners.length);
  // Newell's: the outline's normal, as long as twice its area.
  const normal = new Vector3();
  corners.forEach((corner, i) =>
    normal.add(
      corner
        .clone()
        .sub(middle)
        .cross(corners[(i + 1) % corners.length]!.clone().sub(middle)),
    ),
  );
  const along = acrossOf(normal.normalize());
  const across = normal.clone().cross(along);
  const flat = corners.map(
    (corner) =>
      new Vector2(corner.clone().sub(middle).dot(along), corner.clone().sub(middle).dot(across)),
  );
  const triangles = ShapeUtils.triangulateShape(flat, []).flat();
  return {
    lines: linesThrough([...points, points[0]!]),
    triangles: triangles.map((i) => points[i]!),
    ends: points,
    labelPlace: middle.toArray(),
  };
}

function patchAt(middle: Vector3, normal: Vector3): Place[] {
  const along = acrossOf(normal).multiplyScalar(patch_m);
  const across = normal.clone().cross(along);
  const corner = (u: number, v: number): Vector3 =>
    middle.clone().addScaledVector(along, u).addScaledVector(across, v);
  const [a, b, c, d] = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
  return placesOf([a, b, c, a, c, d]);
}

// Some direction across another one.
function acrossOf(direction: Vector3): Vector3 {
  const other = Math.abs(direction.y) < 0.9 ? new Vector3(0, 1, 0) : new Vector3(1, 0, 0);
  return other.cross(direction).normalize();
}

function vector(place: Place): Vector3 {
  return new Vector3(...place);
}

function placesOf(vectors: readonly Vector3[]): Place[] {
  return vectors.map((one) => one.toArray());
}

function middleOf(a: Vector3, b: Vector3): Place {
  return a.clone().add(b).multiplyScalar(0.5).toArray();
}
