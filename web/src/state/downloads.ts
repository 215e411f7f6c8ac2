// What a finished scan can be taken away as just now, and what somebody waits for: it is taken as
// soon as the server has made it.
import { errorText } from '../connection/api';
import type { MeshFinish, ScanExport } from '../connection/exports';

const pollEvery_ms = 1_500;

export interface ExportServer {
  list(): Promise<readonly ScanExport[]>;
  make(format: string, finish: MeshFinish): Promise<ScanExport>;
  remove(format: string): Promise<void>;
  load(format: string, progress: (loaded_bytes: number) => void): Promise<Blob>;
}

export interface DownloadsPage {
  show(): void; // something has changed
  say(text: string): void; // what went wrong
  save(blob: Blob, one: ScanExport): void;
  isLookedAt(): boolean;
}

export class Downloads {
  private exports: readonly ScanExport[] = [];
  private readonly wanted = new Set<string>(); // formats that are taken as soon as they are ready
  private readonly loaded_bytes = new Map<string, number>(); // of those that are just taken
  private timer: ReturnType<typeof setTimeout> | undefined;
  private disposed = false;

  constructor(
    private readonly server: ExportServer,
    private readonly page: DownloadsPage,
  ) {}

  get all(): readonly ScanExport[] {
    return this.exports;
  }

  find(format: string): ScanExport | undefined {
    return this.exports.find((one) => one.format === format);
  }

  // How much of it has come; null: it is not being taken.
  loadedOf({ format }: ScanExport): number | null {
    return this.loaded_bytes.get(format) ?? null;
  }

  // Somebody begins to look.
  look(): void {
    void this.attempt(async () => {
      await this.refresh();
      this.page.say('');
    }).then(() => this.pollOn());
  }

  take(chosen: ScanExport | undefined): Promise<void> {
    return this.attempt(async () => {
      this.page.say('');
      let one = chosen;
      if (!one || this.loaded_bytes.has(one.format)) return;
      if (one.state === 'ready') return this.load(one);
      if (one.state === 'missing' || one.state === 'failed')
        this.put((one = await this.server.make(one.of_format, one.finish)));
      this.wanted.add(one.format);
      this.poll();
    });
  }

  remove(format: string): Promise<void> {
    return this.attempt(async () => {
      this.page.say('');
      await this.server.remove(format);
      this.wanted.delete(format);
      await this.refresh();
    });
  }

  dispose(): void {
    this.disposed = true;
    clearTimeout(this.timer);
  }

  private async attempt(work: () => Promise<void>): Promise<void> {
    try {
      await work();
    } catch (error) {
      this.page.say(errorText(error));
    }
    if (!this.disposed) this.page.show();
  }

  private put(one: ScanExport): void {
    const isThere = this.exports.some((old) => old.format === one.format);
    this.exports = isThere
      ? this.exports.map((old) => (old.format === one.format ? one : old))
      : [...this.exports, one];
  }

  private async load(one: ScanExport): Promise<void> {
    this.wanted.delete(one.format);
    this.loaded_bytes.set(one.format, 0);
    this.page.show();
    try {
      const blob = await this.server.load(one.format, (bytes) => {
        this.loaded_bytes.set(one.format, bytes);
        this.page.show();
      });
      if (!this.disposed) this.page.save(blob, one);
    } finally {
      this.loaded_bytes.delete(one.format);
    }
  }

  private async refresh(): Promise<void> {
    this.exports = await this.server.list();
    if (this.disposed) return;
    this.page.show();
    for (const one of this.exports.filter(({ format }) => this.wanted.has(format))) {
      if (one.state === 'ready') void this.attempt(() => this.load(one));
      if (one.state === 'failed' || one.state === 'missing') this.wanted.delete(one.format);
    }
  }

  private poll(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(
      () => void this.attempt(() => this.refresh()).then(() => this.pollOn()),
      pollEvery_ms,
    );
  }

  // While somebody looks or waits and something is going on.
  private pollOn(): void {
    const busy = this.exports.some((one) => one.state === 'queued' || one.state === 'running');
    if (!this.disposed && (this.wanted.size > 0 || (busy && this.page.isLookedAt()))) this.poll();
  }
}
