// How the viewer wants to look at a scan.
import type { Watch } from '../connection/events';

export const shows = ['surface', 'points'] as const;
export type Show = (typeof shows)[number];

export const colorModes = ['shaded', 'rgb', 'normal', 'confidence'] as const; // of points
export type ColorMode = (typeof colorModes)[number];

export const meshColors = ['shaded', 'rgb', 'normal'] as const;
export type MeshColor = (typeof meshColors)[number];

// A share of the size that leaves no gaps.
export const pointSizeRange_percent = { min: 20, max: 300, step: 10 } as const;

export interface ViewOptions {
  readonly show: Show; // the surface as soon as there is one
  readonly color: ColorMode;
  readonly coverage: boolean; // instead of colours: how well each place was seen
  readonly meshColor: MeshColor | null; // null: nobody has chosen
  readonly pointSize_percent: number;
  readonly hideBacks: boolean; // what is seen from behind: walls and ceilings stop hiding the room
  readonly eyeDome: boolean; // points are darker behind edges
  readonly follow: boolean; // the view rides behind the scanning camera
}

export const initialViewOptions: ViewOptions = {
  show: 'surface',
  color: 'shaded',
  coverage: false,
  meshColor: null,
  pointSize_percent: 100,
  hideBacks: true,
  eyeDome: true,
  follow: false,
};

// Light helps to see the shape where there are only colours of points; an image on
// the surface has its own.
export function shownMeshColor(options: ViewOptions, textured: boolean): MeshColor {
  return options.meshColor ?? (textured ? 'rgb' : 'shaded');
}

// Coverage is shown on a surface whose vertices have confidences, otherwise on points.
export function asksForSurface({ show, coverage }: ViewOptions, hasConfidences: boolean): boolean {
  return show === 'surface' && (!coverage || hasConfidences);
}

// What is shown is what is asked for. Until it is known what the surface that grows has (null),
// coverage is on points, and the surface is asked for to learn it.
export function watchOf(options: ViewOptions, hasConfidences: boolean | null): Watch {
  return {
    points: !asksForSurface(options, hasConfidences === true),
    mesh: asksForSurface(options, hasConfidences !== false),
  };
}

export function reduceViewOptions(options: ViewOptions, change: Partial<ViewOptions>): ViewOptions {
  return { ...options, ...change };
}

// What stays chosen, also for other scans and after a reload.
const storedAs = 'hermite.show';

export function storedShow(storage: Pick<Storage, 'getItem'>): Show {
  return storage.getItem(storedAs) === 'points' ? 'points' : 'surface';
}

export function storeShow(storage: Pick<Storage, 'setItem'>, show: Show): void {
  try {
    storage.setItem(storedAs, show);
  } catch {
    // A browser that keeps nothing.
  }
}
