// What the panel of frames is made of: the images of a moment, what is said of it, and the buttons
// that lead to others.
import type { DepthRange } from '../connection/frames';
import { metresText } from '../state/quantities';
import { t } from '../texts/texts';
import { buttonOf, element, setText } from './dom';
import { frameImage } from './frame_image';
import { statusMark } from './mark';

export type FramesView = ReturnType<typeof framesView>;

export function framesView() {
  const act = (text: string, label: string, title = ''): HTMLButtonElement =>
    buttonOf(text, { 'aria-label': label, title });
  const scale = depthScale();
  const color = frameImage(t.colourImage, t.colour);
  const depth = frameImage(t.depthImageRedIsNearBlue, t.depth, scale.element);
  const number = element('strong');
  const time = element('span', { class: 'frame-time' });
  const status = statusMark();
  const facts = element('div', { class: 'frame-facts' }, number, time, status.element);
  const reason = element('p', { class: 'frame-reason' }); // why it was weak or lost
  const note = element('p', { class: 'notice', role: 'status' });
  const slider = element('input', {
    type: 'range',
    min: 0,
    max: 0,
    step: 1,
    value: 0,
    'aria-label': t.frame,
  });
  const [before, play, after] = [
    act('‹', t.frameBefore),
    act(t.play, t.play, t.atTheSpeedOfTheCamera),
    act('›', t.nextFrame),
  ];
  const through = act(t.lookThrough, t.lookThroughTheCamera, t.movesTheViewToWhereThe);
  const done = act(t.close, t.closeTheFrames);
  const found = element(
    'div',
    { class: 'frames-found' },
    element('div', { class: 'frame-pictures' }, color.element, depth.element),
    facts,
    reason,
    slider,
  );
  const buttons = element('div', { class: 'buttons' }, before, play, after, through);
  const node = element(
    'section',
    { class: 'card frames', 'aria-label': t.frames },
    note,
    found,
    element('div', { class: 'frames-foot' }, buttons, done),
  );
  return {
    node,
    note,
    found,
    buttons,
    color,
    depth,
    scale,
    number,
    time,
    status,
    reason,
    slider,
    before,
    play,
    after,
    through,
    done,
  };
}

// Which depths the first and the last colour of the depth image stand for.
function depthScale() {
  const [near, far] = [element('span'), element('span')];
  return {
    element: element(
      'span',
      { class: 'depth-scale' },
      near,
      element('span', { class: 'depth-colors', 'aria-hidden': 'true' }),
      far,
    ),
    show({ from_mm, to_mm }: DepthRange): void {
      setText(near, metresText(from_mm / 1000, 1));
      setText(far, metresText(to_mm / 1000, 1));
    },
  };
}
