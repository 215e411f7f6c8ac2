// Makes a share link of one scan and shows it for copying.
import { ApiError, createShareLink } from '../connection/api';
import { t } from '../texts/texts';
import { buttonOf, element, setText } from './dom';

// `view`: how the scan is looked at now, as fields of an address, or empty.
export function shareButton(
  scanId: string,
  token: string,
  problem: Element,
  view: () => string,
): HTMLElement {
  const button = buttonOf(t.share, { title: t.makesALinkWithWhichOthers });
  const link = element('input', {
    class: 'share-link',
    type: 'text',
    readonly: true,
    'aria-label': t.linkToThisScan,
  });
  const message = element('span', { class: 'share-words', role: 'status' });
  const node = element('span', { class: 'share' }, message, link, button);
  link.hidden = true;
  const share = async (): Promise<void> => {
    button.disabled = true;
    setText(problem, '');
    try {
      link.value = [await createShareLink(scanId, token), view()].filter(Boolean).join('&');
      link.hidden = false;
      button.hidden = true;
      link.select();
      setText(
        message,
        (await copied(link.value)) ? t.copiedShowsThisScanFor7 : t.showsThisScanFor7Days,
      );
    } catch (error) {
      setText(problem, error instanceof ApiError ? error.message : t.theLinkCouldNotBeMade);
    }
    button.disabled = false;
  };
  button.addEventListener('click', () => void share());
  return node;
}

// Browsers allow it only to pages that come over TLS or from this machine.
async function copied(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
}
