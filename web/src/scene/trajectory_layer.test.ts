import { describe, expect, it } from 'vitest';
import { frame, poses } from './played';
import { SubmapsLayer } from './submaps_layer';
import { TrajectoryLayer } from './trajectory_layer';

function play(...events: Parameters<TrajectoryLayer['onEvent']>[0][]): {
  xs: () => number[];
  tell: (event: (typeof events)[0], ms: number) => void;
} {
  const submaps = new SubmapsLayer();
  const path = new TrajectoryLayer(submaps);
  const tell = (event: (typeof events)[0], elapsed_ms: number): void => {
    for (const layer of [submaps, path]) layer.onEvent(event);
    submaps.tick(elapsed_ms);
    path.tick();
  };
  for (const event of events) tell(event, 1000);
  const xs = (): number[] => {
    const position = path.object.geometry.getAttribute('position');
    return Array.from({ length: path.object.geometry.drawRange.count }, (_, i) => position.getX(i));
  };
  return { xs, tell };
}

describe('TrajectoryLayer', () => {
  it('bends with the submaps as they are corrected', () => {
    const path = play(poses([0, 10]), frame(0, 1), frame(1, 1));
    expect(path.xs()).toEqual([1, 11]);
    path.tell(poses([0, 11]), 150);
    expect(path.xs()).toEqual([1, 11.5]); // half of the way, as the points
    path.tell(frame(1, 2), 1000);
    expect(path.xs()).toEqual([1, 12, 13]);
  });

  it('places the past, which comes before the poses', () => {
    const past = {
      kind: 'trajectory',
      positions_m: Float32Array.of(1, 0, 0, 2, 0, 0),
      submaps: Uint32Array.of(0, 1),
    } as const;
    expect(play(past, poses([0, 10])).xs()).toEqual([1, 12]);
  });

  it('takes another past in place of its own, as of a map that was made anew', () => {
    const past = {
      kind: 'trajectory',
      positions_m: Float32Array.of(4, 0, 0),
      submaps: Uint32Array.of(0),
    } as const;
    expect(play(poses([0]), frame(0, 1), frame(0, 2), past, frame(0, 5)).xs()).toEqual([4, 5]);
  });

  it('leaves a path in the world where it is', () => {
    const past = {
      kind: 'trajectory',
      positions_m: Float32Array.of(1, 0, 0),
      submaps: null,
    } as const;
    const path = play(poses([5]), past, frame(0, 2, { inSubmap: null }));
    path.tell(poses([7]), 1000);
    expect(path.xs()).toEqual([1, 2]);
  });

  it('leaves out where the camera was lost, and begins afresh after reconnecting', () => {
    const welcome = { kind: 'welcome', title: '', camera: null } as const;
    const path = play(frame(0, 1), frame(0, 2, { tracking: 'lost' }), frame(0, 3));
    expect(path.xs()).toEqual([1, 3]);
    path.tell(welcome, 0);
    expect(path.xs()).toEqual([]);
  });

  it('grows beyond its first capacity', () => {
    const many = 3000;
    const positions_m = Float32Array.from({ length: 3 * many }, (_, i) =>
      i % 3 === 0 ? i / 3 : 0,
    );
    const path = play(
      { kind: 'trajectory', positions_m, submaps: new Uint32Array(many) },
      frame(0, 5),
      poses([100]),
    );
    expect(path.xs()).toHaveLength(many + 1);
    expect(path.xs()[many - 1]).toBe(100 + many - 1);
    expect(path.xs()[many]).toBe(105);
  });
});
