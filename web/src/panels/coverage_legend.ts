// What the colours of coverage mean, and how much of the model has which.
import type { ScanScene } from '../scene/scene';
import { coverageOf, type Coverage } from '../state/coverage';
import type { LiveScan } from '../state/live_scan';
import type { Store } from '../state/store';
import type { ViewOptions } from '../state/view_options';
import { t } from '../texts/texts';
import { element, setText, type Panel } from './dom';

const refresh_ms = 1000;

const kinds: readonly (readonly [keyof Coverage, string])[] = [
  ['low', t.needsAnotherLook],
  ['fair', t.nearlyEnough],
  ['good', t.scannedWell],
];

export function coverageLegend(
  options: Store<ViewOptions, never>,
  scan: Store<LiveScan, never>,
  scene: Pick<ScanScene, 'confidences'>,
): Panel {
  const shares = kinds.map(() => element('span', { class: 'coverage-share' }));
  const rows = kinds.map(([kind, label], i) =>
    element(
      'li',
      {},
      element('span', { class: `coverage-color ${kind}`, 'aria-hidden': 'true' }),
      element('span', {}, label),
      shares[i]!,
    ),
  );
  const node = element(
    'section',
    { class: 'coverage', 'aria-label': t.coverage, title: t.eachFrameThatSeesAPlace },
    element('ul', {}, ...rows),
  );
  let timer: ReturnType<typeof setInterval> | undefined;
  const count = (): void => {
    const coverage = coverageOf(scene.confidences());
    kinds.forEach(([kind], i) =>
      setText(shares[i]!, coverage ? `${Math.round(100 * coverage[kind])} %` : '–'),
    );
  };
  const show = (): void => {
    const on = options.get().coverage && scan.get().framesReceived > 0;
    node.hidden = !on;
    if (on === (timer !== undefined)) return;
    clearInterval(timer);
    timer = on ? setInterval(count, refresh_ms) : undefined;
    if (on) count();
  };
  const unsubscribers = [options.subscribe(show), scan.subscribe(show)];
  return {
    element: node,
    dispose() {
      clearInterval(timer);
      for (const unsubscribe of unsubscribers) unsubscribe();
    },
  };
}
