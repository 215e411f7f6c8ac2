import { CanvasTexture, Sprite } from 'three';
import { expect, test } from 'vitest';
import { NoteLayer, pinAt, shortened, type NotePin } from './note_layer';

const pin = (number: number, x_m: number, text = ''): NotePin => ({
  position_m: [x_m, 0, 1],
  number,
  text,
});

test('each note has a pin with its number, drawn once, and one of them has text', () => {
  const said: string[] = [];
  const painted: number[] = [];
  const label = {
    object: new Sprite(),
    say: (text: string) => said.push(text),
    resize: () => {},
    dispose: () => {},
  };
  const layer = new NoteLayer(
    () => label,
    (number) => {
      painted.push(number);
      return new CanvasTexture({ width: 1, height: 1 } as HTMLCanvasElement);
    },
  );
  const pins = (): number => layer.object.children.length - 1; // besides the text
  layer.show([pin(1, 0), pin(2, 5, 'a crack\nin the wall')]);
  expect(pins()).toBe(2);
  expect(said.at(-1)).toBe('a crack …');
  expect(label.object.position.toArray()).toEqual([5, 0, 1]);
  layer.show([pin(1, 0, 'here'), pin(2, 5), pin(3, 6)]);
  expect(pins()).toBe(3);
  layer.show([pin(1, 6)]);
  expect(pins()).toBe(1);
  expect(said.at(-1)).toBe('');
  expect(painted).toEqual([1, 2, 3]);
  layer.dispose();
});

test('a tap on a pin is above its tip, and the nearest pin is meant', () => {
  const pins = [pin(1, 100), pin(2, 130), pin(3, -1)];
  const screenOf = ([x_m]: NotePin['position_m']) => (x_m < 0 ? null : ([x_m, 200] as const));
  expect(pinAt(pins, [100, 180], screenOf)).toBe(0);
  expect(pinAt(pins, [120, 180], screenOf)).toBe(1);
  expect(pinAt(pins, [100, 215], screenOf)).toBeNull();
  expect(pinAt([], [100, 180], screenOf)).toBeNull();
});

test('a long text beside a pin is cut between characters', () => {
  expect(shortened('🧱'.repeat(49))).toBe(`${'🧱'.repeat(48)} …`);
  expect(shortened('short')).toBe('short');
});
