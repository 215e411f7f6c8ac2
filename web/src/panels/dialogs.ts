// What stands in front of everything for a moment. The browser keeps the focus in,
// and closes it on Escape.
import { errorText } from '../connection/api';
import { tagsIn } from '../state/scan_list';
import { t } from '../texts/texts';
import { buttonOf, element } from './dom';

const maxTitle_bytes = 200; // the server's kMaxTitleBytes
const [maxTags, maxTag_bytes] = [20, 50]; // its kMaxTagsPerScan and kMaxTagBytes

interface Question {
  readonly heading: string;
  readonly label: string;
  readonly value: string;
  readonly maxLength: number;
  readonly button: string;
  problemOf(text: string): string; // what is wrong with an answer; empty: nothing
  answered(text: string): Promise<void>; // what goes wrong then is said in the dialog
}

function ask(question: Question): void {
  const input = element('input', {
    type: 'text',
    id: 'answer',
    value: question.value,
    autocomplete: 'off',
    maxlength: question.maxLength,
  });
  const problem = element('p', { class: 'problem', role: 'alert' });
  const cancel = buttonOf(t.cancel);
  const form = element(
    'form',
    {},
    element('label', { for: 'answer' }, question.label),
    input,
    problem,
    element(
      'div',
      { class: 'dialog-buttons' },
      cancel,
      element('button', { type: 'submit', class: 'button primary' }, question.button),
    ),
  );
  const close = openDialog(question.heading, form);
  input.select();
  cancel.addEventListener('click', close);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    problem.textContent = question.problemOf(input.value);
    if (problem.textContent !== '') return;
    question.answered(input.value).then(close, (error: unknown) => {
      problem.textContent = errorText(error);
    });
  });
}

const bytesOf = (text: string): number => new TextEncoder().encode(text).length;

export function askForTitle(title: string, rename: (title: string) => Promise<void>): void {
  ask({
    heading: t.rename,
    label: t.titleOfTheScan,
    value: title,
    maxLength: maxTitle_bytes,
    button: t.rename,
    problemOf: (text) =>
      text.trim() === ''
        ? t.aTitleHasAtLeastOne
        : bytesOf(text.trim()) > maxTitle_bytes
          ? t.thisIsLongerThanBytes(maxTitle_bytes)
          : '',
    answered: (text) => rename(text.trim()),
  });
}

export function askForTags(
  tags: readonly string[],
  change: (tags: string[]) => Promise<void>,
): void {
  ask({
    heading: t.tags,
    label: t.tagsWithCommasBetweenThem,
    value: tags.join(', '),
    maxLength: maxTags * (maxTag_bytes + 2),
    button: t.save,
    problemOf: (text) => {
      const wanted = tagsIn(text);
      const long = wanted.find((tag) => bytesOf(tag) > maxTag_bytes);
      if (long !== undefined) return t.theTagIsLongerThanBytes(long, maxTag_bytes);
      return wanted.length > maxTags ? t.aScanHasAtMostTags(maxTags) : '';
    },
    answered: (text) => change(tagsIn(text)),
  });
}

const keys: readonly (readonly [string, string])[] = [
  [t.drag, t.turn],
  [t.rightDragOrTwoFingers, t.move],
  [t.wheelOrPinch, t.zoom],
  [t.doubleClick, t.turnAroundWhatIsThere],
  [t.arrows, t.moveAfterAClickIntoThe],
  ['+  −', t.zoomTheSame],
  ['F', t.showTheWholeScan],
  ['B', t.inACompareOneOver],
  ['S', t.surfaceOrPoints],
  ['I', t.seeInside],
  ['M', t.measureDistancesHeightsAnglesAndAreas],
  ['N', t.notesClickOnTheModelTo],
  ['X', t.clipBoxAndSectionsToDraw],
  ['P', t.theFloorPlanOfAFinished],
  [`${t.arrows}  +  −  0`, t.inTheFloorPlanMoveZoom],
  ['E', t.eyeDomeLightingOfPoints],
  ['T', t.lookBackAllFramesOfThe],
  [t.leftRightSpace, t.frameBeforeNextFramePlayOn],
  ['Q', t.theQualityOfTheScanOn],
  ['V', t.coverageWhatWasScannedWellWhat],
  ['L', t.whatTheCameraSeesWhileIt],
  ['C', t.followTheCameraWhileItScans],
  ['?', t.thisHelp],
  [t.esc, t.closeWhatIsOpen],
];

export function showHelp(): void {
  const rows = keys.map(([key, description]) =>
    element('div', {}, element('dt', {}, element('kbd', {}, key)), element('dd', {}, description)),
  );
  const done = buttonOf(t.close, { class: 'button primary' });
  const close = openDialog(
    t.mouseTouchAndKeyboard,
    element(
      'div',
      {},
      element('dl', { class: 'keys' }, ...rows),
      element('div', { class: 'dialog-buttons' }, done),
    ),
  );
  done.addEventListener('click', close);
}

// One at a time.
export function openDialog(title: string, content: HTMLElement): () => void {
  document.querySelector('dialog')?.remove();
  const dialog = element(
    'dialog',
    { class: 'dialog', 'aria-labelledby': 'dialog-title' },
    element('h2', { id: 'dialog-title' }, title),
    content,
  );
  const close = (): void => dialog.close();
  dialog.addEventListener('close', () => dialog.remove());
  // A click beside it.
  dialog.addEventListener('click', (event) => event.target === dialog && close());
  document.body.append(dialog);
  dialog.showModal();
  return close;
}
