// How the viewer wants to look at a scan.

export const shows = ['surface', 'points'] as const;
export type Show = (typeof shows)[number];

export const colorModes = ['shaded', 'rgb', 'normal', 'confidence'] as const; // of points
export type ColorMode = (typeof colorModes)[number];

export const meshColors = ['shaded', 'rgb', 'normal'] as const;
export type MeshColor = (typeof meshColors)[number];

export const pointSizeRange_percent = { min: 20, max: 300, step: 10 } as const; // of what leaves no gaps

export interface ViewOptions {
  readonly show: Show; // the surface as soon as there is one
  readonly color: ColorMode;
  readonly coverage: boolean; // instead of colours: how well each place was seen, on points
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

// Light helps to see the shape where there are only colours of points; an image on the surface has its own.
export function shownMeshColor(options: ViewOptions, textured: boolean): MeshColor {
  return options.meshColor ?? (textured ? 'rgb' : 'shaded');
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
