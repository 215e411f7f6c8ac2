// What stands in front of everything for a moment. The browser keeps the focus in, and closes it on Escape.
import { errorText } from '../connection/api';
import { t } from '../texts/texts';
import { element } from './dom';

const maxTitle_bytes = 200; // the server's kMaxTitleBytes

// `rename` is called with the new title; what goes wrong is said in the dialog.
export function askForTitle(title: string, rename: (title: string) => Promise<void>): void {
  const input = element('input', {
    type: 'text',
    id: 'new-title',
    value: title,
    required: true,
    autocomplete: 'off',
    maxlength: maxTitle_bytes,
  });
  const problem = element('p', { class: 'problem', role: 'alert' });
  const cancel = element('button', { type: 'button', class: 'button' }, t.cancel);
  const form = element(
    'form',
    {},
    element('label', { for: 'new-title' }, t.titleOfTheScan),
    input,
    problem,
    element('div', { class: 'dialog-buttons' }, cancel, element('button', { type: 'submit', class: 'button primary' }, t.rename)),
  );
  const close = openDialog(t.rename, form);
  input.select();
  cancel.addEventListener('click', close);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const wanted = input.value.trim();
    if (wanted === '' || new TextEncoder().encode(wanted).length > maxTitle_bytes) {
      problem.textContent = wanted === '' ? t.aTitleHasAtLeastOne : t.thisIsLongerThanBytes(maxTitle_bytes);
      return;
    }
    rename(wanted).then(close, (error: unknown) => {
      problem.textContent = errorText(error);
    });
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
  const done = element('button', { type: 'button', class: 'button primary' }, t.close);
  const close = openDialog(
    t.mouseTouchAndKeyboard,
    element('div', {}, element('dl', { class: 'keys' }, ...rows), element('div', { class: 'dialog-buttons' }, done)),
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
