import { defineConfig } from 'vitest/config';
import type { Plugin } from 'vite';

// three ships Draco's decoder as a plain script; a module worker needs it as a module.
const dracoAsModule: Plugin = {
  name: 'draco-as-module',
  enforce: 'pre',
  transform(code, id) {
    if (!id.split('?')[0]!.endsWith('/draco_wasm_wrapper.js')) return null;
    const oldExports = code.lastIndexOf('"object"===typeof exports&&"object"===typeof module');
    if (oldExports < 0) throw new Error('draco_wasm_wrapper.js no longer ends as expected');
    return {
      code: `${code.slice(0, oldExports)}\nexport default DracoDecoderModule;\n`,
      map: null,
    };
  },
};

// The page lives under a strict Content-Security-Policy: no inline script or style, no data: or
// blob: code. Hence files for everything.
export default defineConfig({
  base: './',
  plugins: [dracoAsModule],
  worker: { format: 'es', plugins: () => [dracoAsModule] },
  build: {
    target: 'es2022',
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1000,
  },
  test: {
    include: ['src/**/*.test.ts'],
    server: { deps: { inline: [/draco/, /tus-js-client/] } },
    // Node would get another half, which cannot read a File.
    alias: { 'tus-js-client': 'tus-js-client/lib.esm/browser/index.js' },
  },
});
