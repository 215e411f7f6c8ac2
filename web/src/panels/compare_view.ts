// What is seen of two scans: the picture of both, how one lies to the other in it, and the
// list of what has changed.
import type { ComparedPoints } from '../connection/compared_points';
import type { ComparisonState } from '../connection/comparisons';
import type { MeasuredUp } from '../connection/events';
import { CompareScene } from '../scene/compare_scene';
import { looks, type Look } from '../state/comparing';
import { t } from '../texts/texts';
import { comparePanel } from './compare_panel';
import type { CompareParts } from './compare_parts';
import { segments } from './segments';

const lookLabels: Record<Look, string> = { overlay: t.oneOverTheOther, sides: t.sideBySide };

// Both scans, in the first one's world.
export interface ComparedModel {
  readonly points: ComparedPoints;
  readonly measuredUp: MeasuredUp | null; // of the first scan
}

export class CompareView {
  private report: ComparisonState['report'] = null;
  private model: ComparedModel | null = null;
  private look: Look = 'overlay';
  private readonly panel = comparePanel((index) => this.flyTo(index));
  private readonly choice = segments(
    'compare-look',
    t.howBothAreShown,
    looks,
    lookLabels,
    (chosen) => this.setLook(chosen),
  );
  scene: CompareScene | null = null; // null while there is no picture

  constructor(private readonly parts: CompareParts) {
    this.choice.element.hidden = true;
    parts.bar.append(this.choice.element);
    parts.node.append(this.panel.element);
    parts.all.addEventListener('click', () => this.frameAll());
  }

  // All that is to be seen has come.
  get isComplete(): boolean {
    return this.model !== null;
  }

  // `fetchModel`: null when nobody wants it any more.
  async show(
    { report }: ComparisonState,
    fetchModel: () => Promise<ComparedModel | null>,
  ): Promise<void> {
    if (!report) return;
    this.report = report;
    this.panel.show(report);
    if (report.verdict !== 'same_place') return this.parts.say(t.thereIsNoPictureOfBoth);
    this.parts.say(t.loadingTheComparison);
    const model = await fetchModel();
    if (model) this.draw(model);
  }

  swapLook(): void {
    if (this.scene) this.setLook(this.look === 'overlay' ? 'sides' : 'overlay');
  }

  frameAll(): void {
    this.panel.choose(null);
    this.scene?.frameAll();
  }

  private draw(model: ComparedModel): void {
    this.model = model;
    try {
      this.scene = new CompareScene(this.parts.canvas);
    } catch {
      this.parts.say(t.thisBrowserCannotShow3dPictures); // the list of changes is there
      return;
    }
    this.scene.show(model.points.chunks, this.look, model.measuredUp);
    this.choice.element.hidden = this.parts.all.hidden = false;
    this.setLook(this.look);
    this.parts.say('');
  }

  private setLook(chosen: Look): void {
    this.look = chosen;
    this.choice.check(chosen);
    this.parts.node.classList.toggle('sides', chosen === 'sides');
    this.panel.showLook(chosen);
    this.scene?.setLook(chosen);
  }

  private flyTo(index: number): void {
    const region = this.report?.regions[index];
    if (!region || !this.scene) return;
    this.panel.choose(index);
    this.scene.flyTo(region, this.model?.points.regions.get(index));
  }
}
