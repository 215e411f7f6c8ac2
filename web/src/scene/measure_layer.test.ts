import { Sprite } from 'three';
import { expect, test } from 'vitest';
import { MeasureLayer } from './measure_layer';

const one = { from: [0, 0, 1], to: [0, 2, 1], words: '2.000 m ± 0.003 m (95 %)' } as const;

test('each distance has its line and its words in the middle, and what was chosen first a point', () => {
  const said: string[] = [];
  let disposed = 0;
  const layer = new MeasureLayer(() => ({ object: new Sprite(), say: (words) => said.push(words), resize: () => {}, dispose: () => ++disposed }));
  const [lines, ends] = layer.object.children;
  expect([lines!.visible, ends!.visible]).toEqual([false, false]);
  layer.show([], [1, 1, 1]);
  expect([lines!.visible, ends!.visible]).toEqual([false, true]);
  layer.show([one], null);
  expect([lines!.visible, ends!.visible]).toEqual([true, true]);
  expect(said).toEqual([one.words]);
  expect(layer.object.children[2]!.position.toArray()).toEqual([0, 1, 1]);
  layer.show([], null);
  expect(layer.object.children).toHaveLength(2);
  expect(disposed).toBe(1);
});
