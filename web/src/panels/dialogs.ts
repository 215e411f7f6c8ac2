// What stands in front of everything for a moment. The browser keeps the focus in, and closes it on Escape.
import { errorWords } from '../connection/api';
import { element } from './dom';

const maxTitle_bytes = 200; // the server's kMaxTitleBytes

// `rename` is called with the new title; what goes wrong is said in the dialog.
export function askForTitle(title: string, rename: (title: string) => Promise<void>): void {
  const input = element('input', { type: 'text', id: 'new-title', value: title, required: true, autocomplete: 'off', maxlength: maxTitle_bytes });
  const problem = element('p', { class: 'problem', role: 'alert' });
  const cancel = element('button', { type: 'button', class: 'button' }, 'Cancel');
  const form = element(
    'form',
    {},
    element('label', { for: 'new-title' }, 'Title of the scan'),
    input,
    problem,
    element('div', { class: 'dialog-buttons' }, cancel, element('button', { type: 'submit', class: 'button primary' }, 'Rename')),
  );
  const close = openDialog('Rename', form);
  input.select();
  cancel.addEventListener('click', close);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const wanted = input.value.trim();
    if (wanted === '' || new TextEncoder().encode(wanted).length > maxTitle_bytes) {
      problem.textContent = wanted === '' ? 'A title has at least one letter.' : `This is longer than ${maxTitle_bytes} bytes.`;
      return;
    }
    rename(wanted).then(close, (error: unknown) => {
      problem.textContent = errorWords(error);
    });
  });
}

const keys: readonly (readonly [string, string])[] = [
  ['Drag', 'Turn'],
  ['Right drag, or two fingers', 'Move'],
  ['Wheel, or pinch', 'Zoom'],
  ['Double click', 'Turn around what is there'],
  ['Arrows', 'Move, after a click into the picture'],
  ['+  −', 'Zoom, the same'],
  ['F', 'Show the whole scan'],
  ['S', 'Surface or points'],
  ['I', 'See inside'],
  ['M', 'Measure distances, heights, angles and areas'],
  ['N', 'Notes: click on the model to write one'],
  ['X', 'Clip box, and sections to draw and to download'],
  ['E', 'Eye-dome lighting of points'],
  ['T', 'Look back: all frames of the camera'],
  ['Left, right, space', 'Frame before, next frame, play; on the slider of the frames'],
  ['Q', 'The quality of the scan on a page to print, and back'],
  ['V', 'Coverage: what was scanned well, what needs another look'],
  ['L', 'What the camera sees, while it scans'],
  ['C', 'Follow the camera, while it scans'],
  ['?', 'This help'],
  ['Esc', 'Close what is open'],
];

export function showHelp(): void {
  const rows = keys.map(([key, words]) => element('div', {}, element('dt', {}, element('kbd', {}, key)), element('dd', {}, words)));
  const done = element('button', { type: 'button', class: 'button primary' }, 'Close');
  const close = openDialog('Mouse, touch and keyboard', element('div', {}, element('dl', { class: 'keys' }, ...rows), element('div', { class: 'dialog-buttons' }, done)));
  done.addEventListener('click', close);
}

// One at a time.
function openDialog(title: string, content: HTMLElement): () => void {
  document.querySelector('dialog')?.remove();
  const dialog = element('dialog', { class: 'dialog', 'aria-labelledby': 'dialog-title' }, element('h2', { id: 'dialog-title' }, title), content);
  const close = (): void => dialog.close();
  dialog.addEventListener('close', () => dialog.remove());
  // A click beside it.
  dialog.addEventListener('click', (event) => event.target === dialog && close());
  document.body.append(dialog);
  dialog.showModal();
  return close;
}
