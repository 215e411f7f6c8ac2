// Where the camera was lost or doubtful: when, for how long, why, and what it saw there.
import { ApiError } from '../connection/api';
import { fetchColor, fetchDepth, type FrameList } from '../connection/frames';
import { doubtText, imageText } from '../state/quality_text';
import { clockText } from '../state/quantities';
import { reasonOf } from '../state/reasons';
import { frameHash } from '../state/route';
import type { Doubt } from '../state/stretches';
import { sentence } from '../state/text';
import { t } from '../texts/texts';
import { element, setText } from './dom';
import { frameImage } from './frame_image';

const most_images = 12; // each is two requests

interface Recording {
  readonly scanId: string;
  readonly token: string;
  readonly signal: AbortSignal; // nobody looks any more
  readonly list: FrameList;
}

// The worst have images, the others a line each.
export function qualityDoubts(doubts: readonly Doubt[], recording: Recording): HTMLElement {
  const byWorth = [...doubts].sort(
    (a, b) =>
      Number(b.follow === 'lost') - Number(a.follow === 'lost') ||
      b.lost_s - a.lost_s ||
      b.weak_s - a.weak_s,
  );
  const worst = new Set(byWorth.slice(0, most_images));
  const rows = doubts.filter((doubt) => worst.has(doubt)).map((doubt) => rowOf(doubt, recording));
  const others = doubts.filter((doubt) => !worst.has(doubt));
  void showAll(rows.map(({ show }) => show));
  const more = element(
    'details',
    { class: 'more-doubts' },
    element('summary', {}, others.length === 1 ? t.oneMorePlace : t.morePlaces(others.length)),
    element(
      'ul',
      {},
      ...others.map((doubt) =>
        element('li', {}, linkOf(doubt, recording.scanId), ` ${textOf(doubt, recording)}`),
      ),
    ),
  );
  more.hidden = others.length === 0;
  return element(
    'div',
    {},
    element('ol', { class: 'doubts' }, ...rows.map(({ node }) => node)),
    more,
  );
}

// One after the other: the server asks to wait when it is asked for many at once.
async function showAll(shows: readonly (() => Promise<void>)[]): Promise<void> {
  for (const show of shows) await show();
}

function linkOf({ from_s, to_s, middle }: Doubt, scanId: string): HTMLElement {
  return element(
    'a',
    { href: frameHash(scanId, middle), title: t.theImagesOfTheCameraAt },
    t.fromTo(clockText(from_s), clockText(to_s)),
  );
}

function textOf(doubt: Doubt, { list }: Recording): string {
  return [`${doubtText(doubt)}.`, sentence(reasonOf(list, doubt))].join(' ').trim();
}

function rowOf(
  doubt: Doubt,
  recording: Recording,
): { readonly node: HTMLElement; readonly show: () => Promise<void> } {
  const { scanId, token, signal } = recording;
  const figure = frameImage(t.colourImageOfFrame(doubt.middle), t.frameNumber(doubt.middle));
  figure.show(t.loadingNow);
  const seen = element('span', { class: 'doubt-seen' });
  const node = element(
    'li',
    { class: 'doubt' },
    figure.element,
    element('div', {}, linkOf(doubt, scanId), element('span', {}, textOf(doubt, recording)), seen),
  );
  const show = async (): Promise<void> => {
    if (signal.aborted) return;
    let brightness: number | null = null;
    const depth = fetchDepth(scanId, token, doubt.middle, null, signal).catch(() => null);
    try {
      const image = await createImageBitmap(await fetchColor(scanId, token, doubt.middle, signal));
      brightness = brightnessOf(image);
      figure.show(image);
    } catch (error) {
      figure.show(error instanceof ApiError ? error.message : t.thisImageCannotBeRead);
    }
    setText(seen, imageText(await depth, brightness));
  };
  return { node, show };
}

// 0 is black, 1 white.
function brightnessOf(image: ImageBitmap): number {
  const side = 16;
  const drawing = Object.assign(document.createElement('canvas'), {
    width: side,
    height: side,
  }).getContext('2d', {
    willReadFrequently: true,
  })!;
  drawing.drawImage(image, 0, 0, side, side);
  const { data } = drawing.getImageData(0, 0, side, side);
  let sum = 0;
  for (let i = 0; i < data.length; i += 4) sum += data[i]! + data[i + 1]! + data[i + 2]!;
  return sum / (3 * 255 * side * side);
}
