// What the server's clock shows, by the newest answer that said so. Without one, the two clocks are
// taken to agree.
export class ServerClock {
  private ahead_ms = 0; // of this computer's

  // `headers`: of an answer that has just come. A cached one would tell an old time. The date is in
  // whole seconds.
  hear(headers: Headers, now_ms: number): void {
    if (headers.get('Cache-Control') !== 'no-store') return;
    const said_ms = Date.parse(headers.get('Date') ?? '');
    if (Number.isFinite(said_ms)) this.ahead_ms = said_ms + 500 - now_ms;
  }

  now(now_ms: number): Date {
    return new Date(now_ms + this.ahead_ms);
  }
}

export const serverClock = new ServerClock();
