// Where the model is on the page, and what of it lies at a point of the page. Points of the page
// are in pixels; places are in the world of the scan, or of the view, which is turned upright.
import { Matrix4, Ray, Raycaster, Vector2, Vector3, type Camera } from 'three';
import type { Place } from '../connection/measurements';
import type { Direction } from './gravity';
import type { HiddenParts } from './hidden_parts';
import type { Hit } from './layer';
import type { LiveMeshLayer } from './live_mesh_layer';
import type { MeshLayer } from './mesh_layer';
import type { PointsLayer } from './points_layer';
import type { Upright } from './upright';

const aroundClick_px = 14; // the floor is what most of the surface there faces

interface Shown {
  readonly points: PointsLayer;
  readonly live: LiveMeshLayer;
  readonly mesh: MeshLayer;
  readonly hidden: HiddenParts;
}

export class OnPage {
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly camera: Camera,
    private readonly upright: Upright,
    private readonly shown: Shown,
  ) {}

  inView(place: Place): Vector3 {
    return new Vector3(...place).applyMatrix4(this.upright.object.matrix);
  }

  get worldFromView(): Matrix4 {
    return new Matrix4().copy(this.upright.object.matrix).invert();
  }

  // Null: it is behind the viewer.
  placeOf(place: Place): readonly [number, number] | null {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const { x, y, z } = this.inView(place).project(this.camera);
    return z > 1 ? null : [left + ((x + 1) / 2) * width, top + ((1 - y) / 2) * height];
  }

  // From the eye, in the world of the scan.
  rayAt(x_px: number, y_px: number): Ray {
    return new Ray().copy(this.casterAt(x_px, y_px).ray).applyMatrix4(this.worldFromView);
  }

  // What is seen there; null: nothing is.
  hitAt(x_px: number, y_px: number): Hit | null {
    const { points, live } = this.shown;
    const caster = this.casterAt(x_px, y_px);
    const { worldFromView } = this;
    const ray = new Ray().copy(caster.ray).applyMatrix4(worldFromView);
    const hits = [points, live].flatMap((layer) =>
      layer.object.visible ? (layer.pick(ray) ?? []) : [],
    );
    const onMesh = this.onMesh(caster, worldFromView);
    if (onMesh) hits.push(onMesh);
    return hits.sort((a, b) => a.distance_m - b.distance_m)[0] ?? null;
  }

  // What most of the surface around there faces; null: there is none.
  facingAt(x_px: number, y_px: number): Direction | null {
    const middle = this.hitAt(x_px, y_px);
    if (!middle || middle.normal.lengthSq() === 0) return null;
    const normal = middle.normal.clone();
    for (let i = 0; i < 8; ++i) {
      const [dx, dy] = [Math.cos((i * Math.PI) / 4), Math.sin((i * Math.PI) / 4)];
      const beside = this.hitAt(x_px + aroundClick_px * dx, y_px + aroundClick_px * dy);
      if (beside && beside.normal.dot(middle.normal) > 0.9) normal.add(beside.normal);
    }
    return normal.normalize().toArray() as Direction;
  }

  private casterAt(x_px: number, y_px: number): Raycaster {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const caster = new Raycaster();
    caster.setFromCamera(
      new Vector2((2 * (x_px - left)) / width - 1, 1 - (2 * (y_px - top)) / height),
      this.camera,
    );
    return caster;
  }

  // The finished surface, where it is shown.
  private onMesh(caster: Raycaster, worldFromView: Matrix4): Hit | null {
    const { mesh, hidden } = this.shown;
    if (!mesh.object.visible) return null;
    const hit = caster
      .intersectObjects(mesh.fronts(), false)
      .find(({ point }) => hidden.shows(point.clone().applyMatrix4(worldFromView)));
    if (!hit?.face) return null;
    return {
      point_m: hit.point.clone().applyMatrix4(worldFromView),
      normal: hit.face.normal
        .clone()
        .transformDirection(hit.object.matrixWorld)
        .transformDirection(worldFromView),
      distance_m: hit.distance,
    };
  }
}
