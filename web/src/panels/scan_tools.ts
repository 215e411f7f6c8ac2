// The tools of a scan's page: live scanning, the tape measure, looking back,
// the section and the notes.
import type { ScanScene } from '../scene/scene';
import type { Cutting, CuttingEvent } from '../state/cutting';
import type { LiveScan, LiveScanEvent } from '../state/live_scan';
import type { Noting, NotingEvent } from '../state/noting';
import type { Store } from '../state/store';
import type { ViewOptions } from '../state/view_options';
import type { EditsWatch } from './edits_watch';
import { framesPanel, type FramesPanel } from './frames_panel';
import { livePanel, type LivePanel } from './live_panel';
import { measurePanel, type MeasurePanel } from './measure_panel';
import { notesPanel, type NotesPanel } from './notes_panel';
import { sectionPanel, type SectionPanel } from './section_panel';

export interface Tools {
  readonly live: LivePanel;
  readonly tape: MeasurePanel;
  readonly frames: FramesPanel;
  readonly section: SectionPanel;
  readonly notes: NotesPanel;
}

interface ToolWorld {
  readonly node: HTMLElement; // of the page
  readonly stage: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  readonly scene: ScanScene;
  readonly scan: Store<LiveScan, LiveScanEvent>;
  readonly options: Store<ViewOptions, Partial<ViewOptions>>;
  readonly cutting: Store<Cutting, CuttingEvent>;
  readonly edits: EditsWatch;
  readonly noting: Store<Noting, NotingEvent>;
  readonly token: string;
  readonly frame: number | null; // that the address names
}

// They stand in the same place: one at a time.
export function toolsOf({
  node,
  stage,
  canvas,
  scene,
  scan,
  options,
  cutting,
  edits,
  noting,
  token,
  frame,
}: ToolWorld): Tools {
  const tape = measurePanel({ canvas, scene, scan, token });
  const closeTape = (): void => {
    if (node.classList.contains('measuring')) tape.toggle();
  };
  const frames: FramesPanel = framesPanel({
    scene,
    scan,
    token,
    first: frame,
    opened() {
      closeTape();
      section.close();
      notes.close();
    },
  });
  const section: SectionPanel = sectionPanel({
    stage,
    canvas,
    scene,
    scan,
    store: cutting,
    edits,
    token,
    opened() {
      closeTape();
      frames.close();
      notes.close();
    },
  });
  const notes: NotesPanel = notesPanel({
    canvas,
    scene,
    scan,
    store: noting,
    token,
    opened() {
      closeTape();
      frames.close();
      section.close();
    },
  });
  for (const { close } of [frames, section, notes]) tape.button.addEventListener('click', close);
  const live = livePanel({ scene, scan, options, token, opened: section.close });
  return { live, tape, frames, section, notes };
}
