// The floor plan of a scan that has ended: made by the server when somebody asks for it first,
// shown, and taken away as a drawing.
import { ApiError, errorText, fileNameOf, saveAs } from '../connection/api';
import { fetchExport, fetchExports, requestExport } from '../connection/exports';
import { t } from '../texts/texts';
import { openDialog } from './dialogs';
import { buttonOf, element, setText } from './dom';
import { zoomable } from './zoomable';

const pollEvery_ms = 1_000;
const drawing = 'plan-svg';
const files = [
  { format: drawing, ending: 'svg', label: 'SVG', hint: t.aDrawingOnPaperWithIts },
  { format: 'plan-dxf', ending: 'dxf', label: 'DXF', hint: t.forProgramsThatDrawInMetres },
  { format: 'plan-json', ending: 'json', label: 'JSON', hint: t.thePlanAsNumbers },
] as const;

export function showFloorPlan(scanId: string, title: string, token: string): void {
  const notice = element('p', { role: 'status' }, t.thePlanIsBeingMade);
  const picture = element('img', { class: 'plan', alt: t.floorPlanOf(title), draggable: 'false' });
  const frame = zoomable(picture, { back: t.wholePlan, keys: t.thePlanArrowsMove });
  const done = buttonOf(t.close, { class: 'button primary' });
  const buttons = files.map(({ format, ending, label, hint }) => {
    const button = buttonOf(label, { title: hint });
    button.addEventListener('click', () => {
      button.disabled = true;
      made(scanId, format, token, stop.signal)
        .then((blob) => saveAs(blob, `${fileNameOf(title) || 'scan'}-plan.${ending}`))
        .catch((error: unknown) => say(error))
        .finally(() => (button.disabled = false));
    });
    return button;
  });
  const take = element(
    'span',
    { class: 'section-files' },
    element('span', {}, t.download),
    ...buttons,
  );
  const content = element(
    'div',
    { class: 'planning' },
    notice,
    frame,
    element('div', { class: 'dialog-buttons' }, take, done),
  );
  frame.hidden = take.hidden = true; // before the dialog looks for what to focus
  const stop = new AbortController();
  const close = openDialog(t.floorPlan, content);
  const say = (error: unknown): void => {
    if (!stop.signal.aborted) setText(notice, errorText(error));
    notice.hidden = false;
  };
  done.addEventListener('click', close);
  content.closest('dialog')?.addEventListener('close', () => {
    stop.abort();
    URL.revokeObjectURL(picture.src);
  });
  made(scanId, drawing, token, stop.signal)
    .then((blob) => {
      if (stop.signal.aborted) return;
      picture.src = URL.createObjectURL(blob);
      frame.hidden = take.hidden = false;
      notice.hidden = true;
      if (document.activeElement === done) frame.focus(); // nobody has gone elsewhere
    })
    .catch(say);
}

// Throws what the server says if it cannot be made.
async function made(
  scanId: string,
  format: string,
  token: string,
  signal: AbortSignal,
): Promise<Blob> {
  let one = await requestExport(scanId, format, token);
  while (one.state !== 'ready') {
    if (one.state === 'failed') throw new ApiError(one.words || t.failed, false);
    await new Promise((resolve) => setTimeout(resolve, pollEvery_ms));
    signal.throwIfAborted();
    one = (await fetchExports(scanId, token)).find((other) => other.format === format) ?? one;
  }
  const blob = await fetchExport(scanId, format, token, () => {}, signal);
  return format === drawing ? new Blob([blob], { type: 'image/svg+xml' }) : blob;
}
