import { BoxGeometry, Group, Mesh, MeshBasicMaterial, Ray, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { initialCutting, reduceCutting, type Cutting, type CuttingEvent } from '../state/cutting';
import { joined, lengthOf } from '../state/section';
import { ClipLayer } from './clip_layer';
import { HiddenParts } from './hidden_parts';
import { LiveMeshLayer } from './live_mesh_layer';
import { MeshLayer } from './mesh_layer';
import { ModelCut } from './model_cut';
import { PointsLayer } from './points_layer';
import { SubmapsLayer } from './submaps_layer';

// A box of 4 x 2 x 3 m, turned by half a right angle, as a finished surface.
function boxed(): { cut: ModelCut; mesh: MeshLayer } {
  const [submaps, clip, hidden, mesh] = [
    new SubmapsLayer(),
    new ClipLayer(),
    new HiddenParts(),
    new MeshLayer(),
  ];
  const box = new Mesh(new BoxGeometry(4, 2, 3), new MeshBasicMaterial());
  box.rotation.y = Math.PI / 6;
  mesh.replace(new Group().add(box));
  const [points, live] = [new PointsLayer(submaps, hidden), new LiveMeshLayer(submaps, hidden)];
  return { mesh, cut: new ModelCut({ points, live, mesh, clip, hidden }) };
}

const up = [0, -1, 0] as const;

describe('ModelCut', () => {
  it('measures a model along its walls', () => {
    const model = boxed().cut.measure(null, up, null)!;
    const sizes = [0, 1, 2].map((k) => model.high_m[k]! - model.low_m[k]!);
    expect(sizes[0]).toBeCloseTo(4, 2);
    expect(sizes[1]).toBeCloseTo(2, 5);
    expect(sizes[2]).toBeCloseTo(3, 2);
    expect(model.floor_m).toBeCloseTo(-1);
  });

  it('cuts the finished surface, inside of the clip box', () => {
    const { cut } = boxed();
    const play = (...events: CuttingEvent[]): Cutting =>
      [
        { kind: 'active', active: true } as const,
        { kind: 'measured', model: cut.measure(null, up, null)! } as const,
        ...events,
      ].reduce(reduceCutting, initialCutting);
    expect(cut.surface).toBe('finished');
    const lengthIn = (state: Cutting): number => lengthOf(joined(cut.show(state)));
    expect(lengthIn(play())).toBe(0);
    expect(lengthIn(play({ kind: 'cut', by: 'horizontal' }))).toBeCloseTo(14, 3);
    expect(lengthIn(play({ kind: 'cut', by: 'vertical' }))).toBeCloseTo(10, 2);
    const half: CuttingEvent[] = [
      { kind: 'clip', on: true },
      { kind: 'face', face: { axis: 0, side: 'low_m' }, to_m: 0 },
      { kind: 'cut', by: 'horizontal' },
    ];
    expect(lengthIn(play(...half))).toBeCloseTo(2 * 2 + 3, 2);
    expect(lengthIn(play({ kind: 'cut', by: 'horizontal' }, { kind: 'moved', at_m: 9 }))).toBe(0);
  });

  it('moves the handle that is nearest along its axis', () => {
    const { cut } = boxed();
    const model = cut.measure(null, up, null)!;
    cut.show(
      [
        { kind: 'active', active: true },
        { kind: 'measured', model },
        { kind: 'clip', on: true },
      ].reduce((state, event) => reduceCutting(state, event as CuttingEvent), initialCutting),
    );
    const top = new Vector3(0, -1, 0);
    const face = cut.handleAt((place) => top.distanceTo(new Vector3(...place)), 0.1)!;
    expect(face).toEqual({ axis: 1, side: 'high_m' });
    expect(cut.handleAt(() => Infinity, 0.1)).toBeNull();
    expect(
      cut.alongHandle(face, new Ray(new Vector3(0.3, -0.4, -9), new Vector3(0, 0, 1))),
    ).toBeCloseTo(0.4);
    expect(cut.alongHandle(face, new Ray(new Vector3(0, 9, 0), new Vector3(0, -1, 0)))).toBeNull();
  });

  it('has nothing to measure where nothing is', () => {
    const { cut, mesh } = boxed();
    mesh.replace(null);
    expect(cut.measure(null, up, null)).toBeNull();
    expect(cut.surface).toBe('none');
  });
});
