// <hermite-viewer src="LINK" title="TEXT">: a scan in a page of another site, for which the server
// of the scan must allow that site (setting embed-in). LINK is a share link. The element is a block
// of 16:10; CSS may give it any other size.
// For a page like any other: a classic script without dependencies, which may be
// copied to other servers.
(() => {
  if (customElements.get('hermite-viewer')) return;

  class HermiteViewer extends HTMLElement {
    static observedAttributes = ['src', 'title'];

    #frame = document.createElement('iframe');

    constructor() {
      super();
      // A page's own policy does not forbid this, as it may forbid a style element.
      const style = new CSSStyleSheet();
      style.replaceSync(`
        :host { display: block; aspect-ratio: 16 / 10; }
        :host([hidden]) { display: none; }
        iframe { width: 100%; height: 100%; border: 0; }
      `);
      this.#frame.allow = 'fullscreen';
      this.#frame.loading = 'lazy';
      const root = this.attachShadow({ mode: 'open' });
      root.adoptedStyleSheets = [style];
      root.append(this.#frame);
    }

    attributeChangedCallback(name, _before, value) {
      if (name === 'title') this.#frame.title = value ?? '';
      else this.#show(value ?? '');
    }

    // What is no link of a scan is not shown: a page must not be able to
    // make this element run code.
    #show(link) {
      let url;
      try {
        url = new URL(link, document.baseURI);
      } catch {
        url = null;
      }
      const isWeb = url?.protocol === 'https:' || url?.protocol === 'http:';
      const isLink = isWeb && url.hash.length > 1;
      if (!isLink) {
        this.#frame.removeAttribute('src');
        if (link) console.error(`hermite-viewer: "${link}" is no link to a scan`);
        return;
      }
      if (!url.hash.split('&').includes('embed=1')) url.hash += '&embed=1';
      this.#frame.src = url.href;
    }
  }

  customElements.define('hermite-viewer', HermiteViewer);
})();
