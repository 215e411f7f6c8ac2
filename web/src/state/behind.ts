// How far what is on the screen is behind what the camera sends. The server tells how long it took,
// by its own clock; the browser adds what it measured by its own. Two clocks are never compared,
// hence the way from the camera to the server is in none of these.
import type { ServerDelays } from '../connection/frames';
import { t } from '../texts/texts';
import { durationText, secondsText } from './quantities';

// By the clock of the browser.
export interface Exchange {
  readonly asked_ms: number;
  readonly answered_ms: number; // the beginning of the answer was here
}

export interface Behind {
  readonly image_ms: number | null;
  readonly model_ms: number | null; // points or surface
  readonly server_ms: number | null; // the part of the server in that
  readonly way_ms: number; // half of the shortest round trip
}

const remembered = 16; // of the newest exchanges

export class BehindMeter {
  private roundTrips_ms: number[] = [];
  private model_ms: number[] = [];

  // A change of the model was drawn that long after it came.
  modelDrawn(took_ms: number): void {
    this.model_ms = [...this.model_ms, took_ms].slice(-remembered);
  }

  // The image that came with `delays` is on the screen since `drawn_ms`.
  imageDrawn(
    delays: ServerDelays,
    { asked_ms, answered_ms }: Exchange,
    drawn_ms: number,
    showsSurface: boolean,
  ): Behind {
    this.roundTrips_ms = [...this.roundTrips_ms, answered_ms - asked_ms].slice(-remembered);
    const way_ms = Math.min(...this.roundTrips_ms) / 2;
    const server_ms = showsSurface ? delays.surface_ms : delays.points_ms;
    const own_ms = this.model_ms.length > 0 ? medianOf(this.model_ms) : null;
    return {
      image_ms:
        delays.frameAge_ms === null ? null : delays.frameAge_ms + way_ms + drawn_ms - answered_ms,
      model_ms: server_ms === null || own_ms === null ? null : server_ms + way_ms + own_ms,
      server_ms,
      way_ms,
    };
  }
}

function medianOf(values: readonly number[]): number {
  return [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)]!;
}

const delayText = (duration_ms: number): string => durationText(duration_ms / 1000);

// Empty while nothing is known.
export function behindText({ image_ms, model_ms }: Behind): string {
  const parts = [
    ...(model_ms === null ? [] : [t.model(delayText(model_ms))]),
    ...(image_ms === null ? [] : [t.images(delayText(image_ms))]),
  ];
  return parts.length === 0 ? '' : t.delay(parts.join(', '));
}

export function behindParts({ model_ms, server_ms }: Behind): string {
  const own = t.fromWhenTheServerHasA;
  if (model_ms === null || server_ms === null) return own;
  return t.ofTheModelsTheServerTakes(
    own,
    delayText(model_ms),
    delayText(server_ms),
    delayText(model_ms - server_ms),
  );
}

const quiet_ms = 3000; // cameras that send, send more often

// What is said when no frame has come for long; empty: it is not long.
export function silenceText(since_ms: number): string {
  return since_ms < quiet_ms ? '' : t.noNewFrameFor(secondsText(since_ms / 1000));
}
