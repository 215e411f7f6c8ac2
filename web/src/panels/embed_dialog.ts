// What the page of another site has in its source to show a scan: made when somebody asks for it,
// with a share link of its own.
import { createShareLink, errorText } from '../connection/api';
import { elementHtml, frameHtml } from '../state/embed';
import { t } from '../texts/texts';
import { openDialog } from './dialogs';
import { buttonOf, element } from './dom';

const days = 365; // the most that the server allows

// `view`: how the scan is looked at now, as fields of an address, or empty.
export function showEmbedding(scanId: string, title: string, token: string, view: string): void {
  const problem = element('p', { class: 'problem', role: 'alert' });
  const frame = source(t.asAFrame);
  const own = source(t.asAnElement);
  const done = buttonOf(t.close, { class: 'button primary' });
  const content = element(
    'div',
    { class: 'embedding' },
    element('p', {}, t.whoeverReadsThePageSees(days)),
    problem,
    frame.element,
    own.element,
    element('div', { class: 'dialog-buttons' }, done),
  );
  done.addEventListener('click', openDialog(t.embed, content));
  createShareLink(scanId, token, { name: t.embedded, days }).then(
    (shared) => {
      const link = view ? `${shared}&${view}` : shared;
      frame.show(frameHtml(link, title));
      own.show(elementHtml(link, title, shared.slice(0, shared.indexOf('#'))));
    },
    (error: unknown) => {
      problem.textContent = errorText(error, t.theLinkCouldNotBeMade);
    },
  );
}

function source(label: string): { element: HTMLElement; show(html: string): void } {
  const text = element('textarea', { rows: 3, readonly: true, spellcheck: 'false' });
  text.addEventListener('focus', () => text.select());
  return {
    element: element('label', {}, element('span', {}, label), text),
    show(html) {
      text.value = html;
    },
  };
}
