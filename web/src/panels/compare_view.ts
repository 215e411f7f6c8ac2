// What is seen of two scans: the picture of both, how one lies to the other in it, and the
// list of what has changed.
import type { ComparedPoints } from '../connection/compared_points';
import type { ComparisonState } from '../connection/comparisons';
import { CompareScene } from '../scene/compare_scene';
import { looks, type Look } from '../state/comparing';
import { t } from '../texts/texts';
import { comparePanel } from './compare_panel';
import type { CompareParts } from './compare_parts';
import { segments } from './segments';

const lookLabels: Record<Look, string> = { overlay: t.oneOverTheOther, sides: t.sideBySide };

export class CompareView {
  private report: ComparisonState['report'] = null;
  private points: ComparedPoints | null = null;
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
    return this.points !== null;
  }

  // `fetchPoints` gets the points of both; null: nobody wants them any more.
  async show(
    { report }: ComparisonState,
    fetchPoints: () => Promise<ComparedPoints | null>,
  ): Promise<void> {
    if (!report) return;
    this.report = report;
    this.panel.show(report);
    if (report.verdict !== 'same_place') return this.parts.say(t.thereIsNoPictureOfBoth);
    this.parts.say(t.loadingTheComparison);
    const points = await fetchPoints();
    if (points) this.draw(points);
  }

  swapLook(): void {
    if (this.scene) this.setLook(this.look === 'overlay' ? 'sides' : 'overlay');
  }

  frameAll(): void {
    this.panel.choose(null);
    this.scene?.frameAll();
  }

  private draw(points: ComparedPoints): void {
    this.points = points;
    try {
      this.scene = new CompareScene(this.parts.canvas);
    } catch {
      this.parts.say(t.thisBrowserCannotShow3dPictures); // the list of changes is there
      return;
    }
    this.scene.show(points.chunks, this.look);
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
    this.scene.flyTo(region, this.points?.regions.get(index));
  }
}
