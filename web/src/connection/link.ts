// The page's end of the worker: starts it, passes its events on, and starts another one when it
// fails or no longer answers.
import { backoffDelay_ms } from './backoff';
import type { FromWorker, ScanEvent, ToWorker, Watch } from './events';

const askEvery_ms = 5_000;
const unansweredLimit = 6; // half a minute of work on one message is a hang

export interface LinkTarget {
  readonly scanId: string;
  readonly token: string;
  readonly watch: Watch; // to begin with
  onEvent(event: ScanEvent): void;
}

export function socketUrl(page: Pick<Location, 'protocol' | 'host'>): string {
  return `${page.protocol === 'https:' ? 'wss' : 'ws'}://${page.host}/api/v1/ws`;
}

export class ScanLink {
  private worker: Worker | null = null;
  private failures = 0;
  private unanswered = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;

  private wanted: Watch;

  constructor(private readonly target: LinkTarget) {
    this.wanted = target.watch;
    this.start();
  }

  // What to see from now on.
  watch(wanted: Watch): void {
    if (wanted.points === this.wanted.points && wanted.mesh === this.wanted.mesh) return;
    this.wanted = wanted;
    this.post({ kind: 'watch', watch: wanted });
  }

  // After this no event arrives. Ending the worker closes its socket.
  close(): void {
    clearTimeout(this.timer);
    this.worker?.terminate();
    this.worker = null;
  }

  private start(): void {
    const worker = new Worker(new URL('./worker.ts', import.meta.url), { type: 'module' });
    this.worker = worker;
    this.unanswered = 0;
    worker.onmessage = (message: MessageEvent<FromWorker>) => {
      if (worker !== this.worker) return;
      this.unanswered = 0;
      if (message.data.kind !== 'event') return;
      if (message.data.event.kind === 'snapshotEnd') this.failures = 0;
      this.target.onEvent(message.data.event);
    };
    worker.onerror = (event) => {
      event.preventDefault();
      this.restart(event.message || 'the decoder could not be started');
    };
    this.post({
      kind: 'open',
      url: socketUrl(location),
      scanId: this.target.scanId,
      token: this.target.token,
      watch: this.wanted,
    });
    this.timer = setTimeout(() => this.ask(), askEvery_ms);
  }

  private ask(): void {
    if (this.unanswered >= unansweredLimit) {
      this.restart('the decoder no longer answered');
      return;
    }
    ++this.unanswered;
    this.post({ kind: 'alive?' });
    this.timer = setTimeout(() => this.ask(), askEvery_ms);
  }

  private restart(reason: string): void {
    this.close();
    ++this.failures;
    const retryIn_ms = backoffDelay_ms(this.failures, Math.random());
    this.target.onEvent({ kind: 'waiting', retryIn_ms, reason });
    this.timer = setTimeout(() => this.start(), retryIn_ms);
  }

  private post(message: ToWorker): void {
    this.worker?.postMessage(message);
  }
}
