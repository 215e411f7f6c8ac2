// How long a running scan has been going and how fast its frames come, in a few characters.
import { serverClock } from '../connection/server_clock';
import type { LiveScan } from '../state/live_scan';
import { PaceMeter, paceText } from '../state/pace';
import type { Store } from '../state/store';
import { element, setText, type Panel } from './dom';

const tick_ms = 500;

export function scanPace(scan: Store<LiveScan, never>): Panel {
  const node = element('span', { class: 'pace' });
  const meter = new PaceMeter();
  const show = (): void => {
    const text = paceText(
      scan.get(),
      meter.perSecond(performance.now()),
      serverClock.now(Date.now()),
    );
    setText(node, text);
    node.hidden = text === '';
  };
  const unsubscribe = scan.subscribe(({ sequence }) => meter.frame(sequence, performance.now()));
  const timer = setInterval(show, tick_ms);
  show();
  return {
    element: node,
    dispose() {
      unsubscribe();
      clearInterval(timer);
    },
  };
}
