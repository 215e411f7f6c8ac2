// The recording as a strip over time: where the camera was followed, doubtful and lost. A
// click leads to that moment.
import type { FrameList } from '../connection/frames';
import { clockText } from '../state/quantities';
import { frameAt, stripOf, unusedShares, type Follow, type Stretch } from '../state/stretches';
import { t } from '../texts/texts';
import { element, setText } from './dom';

const length = 1000; // of the drawing
const most_pieces = 500; // however long the recording is
const most_bars = 100;
const least = 1.5; // of the length: so much is seen
// Lower where all is well, so that the difference is seen without colours, too.
const tops: Record<Follow, number> = { tracked: 16, weak: 8, lost: 0, unknown: 16, gap: 26 };
const bottom = 32;
const atTexts: Record<Follow, (clock: string) => string> = {
  tracked: t.followedAt,
  weak: t.doubtfulAt,
  lost: t.lostAt,
  unknown: t.notKnownAt,
  gap: t.noFramesAt,
};

function drawn<Tag extends keyof SVGElementTagNameMap>(
  tag: Tag,
  attributes: Readonly<Record<string, string | number>>,
): SVGElementTagNameMap[Tag] {
  const node = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, String(value));
  return node;
}

export function qualityStrip(
  list: FrameList,
  stretches: readonly Stretch[],
  go: (frame: number) => void,
): HTMLElement {
  const whole_s = stretches.at(-1)?.to_s ?? 0;
  const pieces = stripOf(stretches, most_pieces);
  const unused = unusedShares(list, whole_s, most_bars);
  const image = drawn('svg', {
    viewBox: `0 0 ${length} ${unused.length > 0 ? 50 : bottom}`,
    preserveAspectRatio: 'none',
    class: 'strip',
    role: 'img',
    'aria-label': textOf(stretches),
  });
  for (const { follow, from, to } of pieces) {
    const width = Math.max(follow === 'tracked' ? 0 : least, (to - from) * length);
    const x = Math.min(length - width, from * length);
    image.append(
      drawn('rect', {
        x: x.toFixed(2),
        width: width.toFixed(2),
        y: tops[follow],
        height: bottom - tops[follow],
        class: `strip-${follow}`,
      }),
    );
  }
  unused.forEach((share, bar) => {
    if (share > 0)
      image.append(
        drawn('rect', {
          x: (bar * length) / most_bars,
          width: length / most_bars,
          y: 36,
          height: (14 * share).toFixed(2),
          class: 'strip-unused',
        }),
      );
  });
  const readout = element('output', { class: 'strip-readout' });
  const shareOf = (event: MouseEvent): number => {
    const { left, width } = image.getBoundingClientRect();
    return Math.min(1, Math.max(0, (event.clientX - left) / width));
  };
  image.addEventListener('pointermove', (event) => {
    const share = shareOf(event);
    const follow = pieces.find(({ to }) => share <= to)?.follow;
    setText(readout, follow ? atTexts[follow](clockText(share * whole_s)) : '');
  });
  image.addEventListener('pointerleave', () => setText(readout, ''));
  image.addEventListener('click', (event) => {
    const frame = frameAt(list, whole_s, shareOf(event));
    if (frame !== null) go(frame);
  });
  const scale = element(
    'div',
    { class: 'strip-scale' },
    element('span', {}, clockText(0)),
    readout,
    element('span', {}, clockText(whole_s)),
  );
  return element('div', {}, image, scale);
}

function textOf(stretches: readonly Stretch[]): string {
  const number = (follow: Follow): number =>
    stretches.filter((stretch) => stretch.follow === follow).length;
  return t.stripOverTimeWith(number('weak'), number('lost'));
}
