// Taking parts out of a scan: the inside or the outside of the clip box, and what floats. Stands in
// the panel of the clip box.
import { fetchAccess, noAccess } from '../connection/scans';
import type { Cutting, CuttingEvent } from '../state/cutting';
import { boxEdit, type BoxKind, type Editing } from '../state/editing';
import type { Store } from '../state/store';
import { t } from '../texts/texts';
import { buttonOf, element, setText, type Panel } from './dom';
import type { EditsWatch } from './edits_watch';

// The server allows 1 to 1000.
const floating_cm = { min: 5, max: 200, step: 5, value: 30 } as const;

export function editsView(
  edits: EditsWatch,
  cutting: Store<Cutting, CuttingEvent>,
  token: string,
): Panel {
  const act = (text: string, hint: string): HTMLButtonElement => buttonOf(text, { title: hint });
  const [keep, remove] = [
    act(t.keepTheInside, t.removesWhatIsOutside),
    act(t.removeTheInside, t.removesWhatIsInside),
  ];
  const floating = act(t.removeFloatingParts, t.removesPartsSmallerThan);
  const size = sizeSlider();
  const [undo, redo] = [act(t.undo, ''), act(t.redo, '')];
  const notice = element('p', { class: 'edits-notice', role: 'status' });
  const boxes = element('div', { class: 'buttons' }, keep, remove);
  const node = element(
    'div',
    { class: 'edits' },
    boxes,
    element('div', { class: 'buttons' }, floating),
    size.element,
    element('div', { class: 'section-foot' }, notice, undo, redo),
  );
  let access = noAccess;
  let disposed = false;
  const show = (): void => {
    const state = edits.store.get();
    const { clip, axes } = cutting.get();
    node.hidden = !state.known || !access.scan || access.shared;
    boxes.hidden = !clip || !axes;
    for (const button of [keep, remove, floating]) button.disabled = state.busy;
    undo.disabled = state.busy || state.edits.length === 0;
    redo.disabled = state.busy || state.undone.length === 0;
    setText(notice, noticeOf(state));
  };
  const takeOut = (kind: BoxKind): void => {
    const { clip, axes } = cutting.get();
    if (!clip || !axes) return;
    edits.make(boxEdit(kind, axes, clip));
    cutting.dispatch({ kind: 'clip', on: false });
  };
  keep.addEventListener('click', () => takeOut('keep_inside'));
  remove.addEventListener('click', () => takeOut('remove_inside'));
  floating.addEventListener('click', () =>
    edits.make({ kind: 'remove_floating', smaller_than_m: size.size_m() }),
  );
  undo.addEventListener('click', () => edits.undo());
  redo.addEventListener('click', () => edits.redo());
  fetchAccess(token).then(
    (known) => {
      access = known;
      if (!disposed) show();
    },
    () => {}, // then nothing is offered
  );
  const unsubscribers = [edits.store.subscribe(show), cutting.subscribe(show)];
  return {
    element: node,
    dispose() {
      disposed = true;
      for (const unsubscribe of unsubscribers) unsubscribe();
    },
  };
}

// How large a floating part is at most that is taken out.
function sizeSlider(): { readonly element: HTMLElement; size_m(): number } {
  const input = element('input', {
    type: 'range',
    id: 'floating-size',
    ...floating_cm,
    'aria-label': t.removesPartsSmallerThan,
  });
  const text = element('output', { for: 'floating-size' });
  const show = (): void => {
    const size = t.smallerThanCm(input.valueAsNumber);
    setText(text, size);
    input.setAttribute('aria-valuetext', size);
  };
  input.addEventListener('input', show);
  show();
  return {
    element: element('label', { class: 'slider', for: 'floating-size' }, input, text),
    size_m: () => input.valueAsNumber / 100,
  };
}

function noticeOf({ problem, edits }: Editing): string {
  if (problem === 'conflict') return t.somebodyHasChangedTheEdits;
  if (problem !== 'none') return problem;
  return edits.length === 0 ? t.noEdits : t.editsTakenOut(edits.length);
}
