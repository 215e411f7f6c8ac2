// How the viewer wants to look at a scan.

export const colorModes = ['rgb', 'normal', 'confidence'] as const;
export type ColorMode = (typeof colorModes)[number];

export const pointSizeRange_mm = { min: 1, max: 30, step: 1 } as const;

export interface ViewOptions {
  readonly color: ColorMode;
  readonly pointSize_mm: number;
  readonly hideBacks: boolean; // points seen from behind: walls and ceilings stop hiding the room
  readonly follow: boolean; // the view rides behind the scanning camera
}

export const initialViewOptions: ViewOptions = { color: 'rgb', pointSize_mm: 12, hideBacks: true, follow: false };

export function reduceViewOptions(options: ViewOptions, change: Partial<ViewOptions>): ViewOptions {
  return { ...options, ...change };
}
