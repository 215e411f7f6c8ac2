// The scans of the server that the page knows, newest first: those that it tells at once, and older
// ones when somebody has asked for them.
import { withOlder, type ScanSummary } from '../connection/api';

interface ToldScans {
  readonly scans: readonly ScanSummary[];
  readonly more: boolean; // there are older ones
}

export class KnownScans {
  all: readonly ScanSummary[] = [];
  more = false; // there are older ones than these
  private hasOlder = false; // some beyond what the server tells at once

  takeNewest({ scans, more }: ToldScans): void {
    if (!this.hasOlder) this.more = more;
    this.all = this.hasOlder ? withOlder(scans, this.all) : scans;
  }

  takeOlder({ scans, more }: ToldScans): void {
    this.all = withOlder(this.all, scans);
    this.hasOlder = true;
    this.more = more;
  }
}
