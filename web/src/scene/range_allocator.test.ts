import fc from 'fast-check';
import { expect, test } from 'vitest';
import { RangeAllocator } from './range_allocator';

test('what is taken never overlaps, and all of it comes back', () => {
  fc.assert(
    fc.property(
      fc.array(fc.tuple(fc.boolean(), fc.integer({ min: 1, max: 40 })), { maxLength: 80 }),
      (steps) => {
        const allocator = new RangeAllocator(100);
        const taken: { start: number; length: number }[] = [];
        for (const [take, value] of steps) {
          if (take) {
            const start = allocator.take(value);
            if (start === null) continue;
            expect(start + value).toBeLessThanOrEqual(100);
            for (const other of taken)
              expect(start >= other.start + other.length || start + value <= other.start).toBe(
                true,
              );
            taken.push({ start, length: value });
          } else if (taken.length > 0) {
            const [gone] = taken.splice(value % taken.length, 1);
            allocator.give(gone!.start, gone!.length);
          }
          expect(allocator.end).toBe(
            Math.max(0, ...taken.map(({ start, length }) => start + length)),
          );
        }
        for (const { start, length } of taken) allocator.give(start, length);
        expect(allocator.take(100)).toBe(0); // in one piece
      },
    ),
  );
});

test('there is no room for more than there is', () => {
  const allocator = new RangeAllocator(10);
  expect(allocator.take(11)).toBeNull();
  expect(allocator.take(10)).toBe(0);
  expect(allocator.take(1)).toBeNull();
  expect(new RangeAllocator(0).take(1)).toBeNull();
});
