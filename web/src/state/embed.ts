// A scan in a page of another site: the address of the viewer without its tools, and what
// that page has in its source.

const field = 'embed=1'; // of an address, like how the scan is looked at

export const isEmbedded = (view: string): boolean => view.split('&').includes(field);

// `link`: a share link, perhaps with how the scan is looked at.
export const embeddedLink = (link: string): string => `${link}&${field}`;

// The same link without it, to open all of the viewer.
export const wholeLink = (link: string): string => link.replace(`&${field}`, '');

const escaped = (text: string): string =>
  text
    .replaceAll('&', '&amp;')
    .replaceAll('"', '&quot;')
    .replaceAll('<', '&lt;')
    .replaceAll('>', '&gt;');

// One line of HTML that any page can have.
export function frameHtml(link: string, title: string): string {
  return (
    `<iframe src="${escaped(embeddedLink(link))}" title="${escaped(title)}" ` +
    'width="800" height="600" style="border: 0; max-width: 100%" ' +
    'allow="fullscreen" loading="lazy"></iframe>'
  );
}

// The same by the custom element of web/public/hermite-viewer.js. `viewer`: the
// address of the viewer's folder.
export function elementHtml(link: string, title: string, viewer: string): string {
  return (
    `<script src="${escaped(viewer)}hermite-viewer.js" defer></script>\n` +
    `<hermite-viewer src="${escaped(link)}" title="${escaped(title)}"></hermite-viewer>`
  );
}
