// The keys of a scan's page: a letter for what a button or the menu does.
import { hasEnded, type LiveScan } from '../state/live_scan';
import { qualityHash } from '../state/route';
import type { Store } from '../state/store';
import type { ViewOptions } from '../state/view_options';
import { showHelp } from './dialogs';
import { showFloorPlan } from './plan_dialog';
import type { Tools } from './scan_tools';

interface World {
  readonly scan: Store<LiveScan, never>;
  readonly options: Store<ViewOptions, Partial<ViewOptions>>;
  readonly tools: Tools | null; // null: the page has none
  readonly token: string;
  readonly frameAll: () => void;
}

// Returns how to stop.
export function onScanKeys(world: World): () => void {
  const onKey = (event: KeyboardEvent): void => shortcut(event, world);
  document.addEventListener('keydown', onKey);
  return () => document.removeEventListener('keydown', onKey);
}

function shortcut(event: KeyboardEvent, { scan, options, tools, token, frameAll }: World): void {
  const { target } = event;
  const typing =
    target instanceof HTMLTextAreaElement ||
    (target instanceof HTMLInputElement && !['radio', 'range'].includes(target.type));
  if (typing || document.querySelector('dialog') || event.ctrlKey || event.metaKey || event.altKey)
    return;
  if (event.key === 'f') frameAll();
  const now = options.get();
  const { scanId, title, phase } = scan.get();
  if (event.key === 'c') options.dispatch({ follow: !now.follow });
  if (event.key === 's') options.dispatch({ show: now.show === 'surface' ? 'points' : 'surface' });
  if (event.key === 'i') options.dispatch({ hideBacks: !now.hideBacks });
  if (event.key === 'e') options.dispatch({ eyeDome: !now.eyeDome });
  if (event.key === 'l') tools?.live.toggle();
  if (event.key === 'v') options.dispatch({ coverage: !now.coverage });
  if (event.key === 'x') tools?.section.toggle();
  if (event.key === 'p' && hasEnded(phase)) showFloorPlan(scanId, title, token);
  if (event.key === 'q') location.hash = qualityHash(scanId);
  if (event.key === 'm') {
    tools?.frames.close();
    tools?.section.close();
    tools?.notes.close();
    tools?.tape.toggle();
  }
  if (event.key === 't') tools?.frames.toggle();
  if (event.key === 'n') tools?.notes.toggle();
  if (event.key === '?') showHelp();
}
