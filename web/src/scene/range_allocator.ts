// Which parts of a buffer are taken: first fit, and neighbours that are free become one again.

interface Range {
  start: number;
  length: number;
}

export class RangeAllocator {
  private readonly free: Range[]; // in order, no two touch

  constructor(readonly capacity: number) {
    this.free = capacity > 0 ? [{ start: 0, length: capacity }] : [];
  }

  // Where it begins; null: there is no room for so many in one piece.
  take(length: number): number | null {
    const i = this.free.findIndex((free) => free.length >= length);
    const range = this.free[i];
    if (!range || length <= 0) return null;
    const { start } = range;
    range.start += length;
    range.length -= length;
    if (range.length === 0) this.free.splice(i, 1);
    return start;
  }

  // What take() gave.
  give(start: number, length: number): void {
    const next = this.free.findIndex((range) => range.start > start);
    const at = next < 0 ? this.free.length : next;
    this.free.splice(at, 0, { start, length });
    this.join(at);
    if (at > 0) this.join(at - 1);
  }

  // Nothing from here on is taken.
  get end(): number {
    const last = this.free.at(-1);
    return last && last.start + last.length === this.capacity ? last.start : this.capacity;
  }

  private join(i: number): void {
    const [one, other] = [this.free[i], this.free[i + 1]];
    if (!one || !other || one.start + one.length !== other.start) return;
    one.length += other.length;
    this.free.splice(i + 1, 1);
  }
}
