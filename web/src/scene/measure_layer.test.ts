import { Sprite } from 'three';
import { expect, test } from 'vitest';
import type { Measured } from '../connection/measurements';
import { MeasureLayer } from './measure_layer';

const one: Measured = {
  kind: 'distance',
  points: [
    [0, 0, 1],
    [0, 2, 1],
  ],
  normals: [],
  words: '2.000 m ± 0.003 m (95 %)',
};
const area: Measured = {
  kind: 'area',
  points: [
    [0, 0, 1],
    [0, 2, 1],
    [1, 0, 1],
  ],
  normals: [],
  words: '1.000 m² ± 0.003 m² (95 %)',
};

test('what was measured has lines and text, an area its surface, chosen points their way', () => {
  const said: string[] = [];
  let disposed = 0;
  const layer = new MeasureLayer(() => ({
    object: new Sprite(),
    say: (text) => said.push(text),
    resize: () => {},
    dispose: () => ++disposed,
  }));
  // The lines, the ends and the patches of planes.
  const visible = (): boolean[] => layer.object.children.slice(0, 3).map((child) => child.visible);
  expect(visible()).toEqual([false, false, false]);
  layer.show([], [[1, 1, 1]]);
  expect(visible()).toEqual([false, true, false]);
  layer.show(
    [],
    [
      [1, 1, 1],
      [1, 2, 1],
    ],
  );
  expect(visible()).toEqual([true, true, false]);
  layer.show([one], []);
  expect(visible()).toEqual([true, true, false]);
  expect(said).toEqual([one.words]);
  expect(layer.object.children[3]!.position.toArray()).toEqual([0, 1, 1]);
  layer.show([area], []);
  expect(visible()).toEqual([true, true, true]);
  layer.show([], []);
  expect(layer.object.children).toHaveLength(3);
  expect(disposed).toBe(2);
});
