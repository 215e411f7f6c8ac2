// Scans that somebody has deleted a moment ago: they are gone from lists, and from the server only
// when there was time to take it back.

export const undoFor_ms = 6_000;

export interface Deleted {
  readonly id: string;
  readonly title: string;
}

export interface TrashWorld {
  // On the server. `leaving`: the page is about to go, and waits for no answer.
  delete(id: string, leaving: boolean): Promise<void>;
  after(delay_ms: number, action: () => void): () => void; // returns how to stop it
}

export class Trash {
  private readonly waiting = new Map<
    string,
    { readonly one: Deleted; readonly stop: () => void }
  >();
  private readonly gone = new Set<string>(); // that the server was told of

  // `changed`: something came or went; `failed`: the server kept one, and says why.
  constructor(
    private readonly world: TrashWorld,
    private readonly changed: () => void,
    private readonly failed: (one: Deleted, error: unknown) => void,
  ) {}

  has(id: string): boolean {
    return this.waiting.has(id) || this.gone.has(id);
  }

  // The one that can still be taken back, the newest first.
  get newest(): Deleted | null {
    return [...this.waiting.values()].at(-1)?.one ?? null;
  }

  put(one: Deleted): void {
    if (this.has(one.id)) return;
    this.waiting.set(one.id, {
      one,
      stop: this.world.after(undoFor_ms, () => void this.empty(one.id, false)),
    });
    this.changed();
  }

  undo(id: string): void {
    this.waiting.get(id)?.stop();
    if (this.waiting.delete(id)) this.changed();
  }

  // Whoever leaves has not taken it back.
  emptyAll(): void {
    for (const id of [...this.waiting.keys()]) void this.empty(id, true);
  }

  private async empty(id: string, leaving: boolean): Promise<void> {
    const waiting = this.waiting.get(id);
    if (!waiting) return;
    waiting.stop();
    this.waiting.delete(id);
    this.gone.add(id);
    this.changed();
    try {
      await this.world.delete(id, leaving);
    } catch (error) {
      this.gone.delete(id);
      this.changed();
      this.failed(waiting.one, error);
    }
  }
}
