// What the page of a comparison is made of, and what it says while there is nothing to be seen.
import { hashOf } from '../state/route';
import { t } from '../texts/texts';
import { buttonOf, element, setText } from './dom';

export type CompareParts = ReturnType<typeof compareParts>;

export function compareParts(first: string) {
  const canvas = element('canvas', {
    class: 'picture',
    tabindex: 0,
    'aria-label': t.bothScansInThreeDimensionsArrow,
  });
  const names = [
    element('h2', { class: 'compare-name' }),
    element('h2', { class: 'compare-name' }),
  ] as const;
  const { middle, ...waiting } = waitingParts();
  const notice = element('p', { class: 'compare-notice', role: 'status' });
  const all = buttonOf(t.showAll, { class: 'button compare-all', title: t.showsTheWholeScanF });
  const stage = element('div', { class: 'compare-stage' }, canvas, ...names, middle, notice, all);
  const back = element(
    'a',
    { class: 'back', href: hashOf(first), 'aria-label': t.backToTheScan },
    element('span', { 'aria-hidden': 'true' }, '←'),
  );
  const title = element('h1', {}, t.comparison);
  const bar = element('header', { class: 'compare-head' }, back, title);
  const node = element('main', { class: 'compare-page' }, bar, stage);
  notice.hidden = all.hidden = true;
  return { node, bar, canvas, names, title, notice, all, ...waiting };
}

// In the middle, while there is nothing to be seen: what is waited for, and what failed.
function waitingParts() {
  const message = element('p', { class: 'compare-words', role: 'status' });
  const progress = element('progress', {
    class: 'facts',
    max: 1,
    'aria-label': t.progressOfTheComparison,
  });
  const cancel = buttonOf(t.cancel);
  const retry = buttonOf(t.tryAgain, { class: 'button primary' });
  const middle = element(
    'div',
    { class: 'compare-middle' },
    message,
    progress,
    element('div', { class: 'buttons' }, cancel, retry),
  );
  const ready = (mayTry: boolean): void => {
    progress.hidden = cancel.hidden = true;
    retry.hidden = !mayTry;
  };
  const say = (text: string): void => {
    setText(message, text);
    ready(false);
    middle.hidden = text === '';
  };
  ready(false);
  return {
    middle,
    progress,
    cancel,
    retry,
    ready,
    say,
    fail(text: string) {
      say(text);
      retry.hidden = false;
    },
    wait(text: string, done: number | null, mayCancel: boolean) {
      say(text);
      progress.hidden = false;
      if (done === null) progress.removeAttribute('value');
      else progress.value = done;
      cancel.hidden = !mayCancel;
    },
  };
}
