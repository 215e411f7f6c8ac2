// Light or dark, as the system has it. What the style sheet says once is read from there.
import { Color } from 'three';

export interface Theme {
  readonly ground: Color;
  readonly grid: Color;
}

const media = '(prefers-color-scheme: light)';

export function currentTheme(): Theme {
  const style = getComputedStyle(document.documentElement);
  const color = (name: string): Color => new Color(style.getPropertyValue(name).trim());
  return { ground: color('--ground'), grid: color('--grid') };
}

// Returns how to stop.
export function onThemeChange(changed: () => void): () => void {
  const query = matchMedia(media);
  query.addEventListener('change', changed);
  return () => query.removeEventListener('change', changed);
}
