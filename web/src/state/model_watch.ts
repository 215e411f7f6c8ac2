// Keeps the extents of the model, within which the clip box and the section plane
// stand, those of what is seen.
import type { ScanScene } from '../scene/scene';
import type { Cutting, CuttingEvent, Model } from './cutting';
import type { LiveScan } from './live_scan';
import type { Store } from './store';

const measureEvery_ms = 2_000; // while a scan grows

export class ModelWatch {
  private measured_ms = -Infinity;
  private surface: ScanScene['surface']; // that was seen last

  constructor(
    private readonly scene: Pick<ScanScene, 'measureModel' | 'surface'>,
    private readonly store: Pick<Store<Cutting, CuttingEvent>, 'get' | 'dispatch'>,
  ) {
    this.surface = scene.surface;
  }

  measure(): Model | null {
    const { axes, clip, section } = this.store.get();
    this.measured_ms = performance.now();
    // A clip box or a section that is in use stands along the old axes.
    return this.scene.measureModel(clip || section ? axes : null);
  }

  remeasure(): void {
    const model = this.measure();
    if (model) this.store.dispatch({ kind: 'measured', model });
  }

  // The scan has changed. Measures anew where that is due and of use.
  follow(scan: LiveScan): void {
    const { active, clip, section, model } = this.store.get();
    const { surface } = this.scene;
    const isOther = surface !== this.surface;
    this.surface = surface;
    const isDue =
      isOther ||
      (isThereAModel(scan) && !model) ||
      performance.now() - this.measured_ms > measureEvery_ms;
    if (isDue && (active || clip || section)) this.remeasure();
  }
}

export function isThereAModel({ points, triangles, mesh }: LiveScan): boolean {
  return points > 0 || triangles > 0 || mesh.state === 'shown';
}
