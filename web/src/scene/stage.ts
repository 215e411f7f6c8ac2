// What every drawn scene does with its page: it fills its parent, over the ground of the theme.
import type { Scene, WebGLRenderer } from 'three';
import type { GridLayer } from './grid_layer';
import { currentTheme } from './theme';

export function paintGround(scene: Scene, grid: GridLayer): void {
  const theme = currentTheme();
  scene.background = theme.ground;
  grid.paint(theme.grid);
}

// Gives the drawing the size of the canvas's parent; returns its width over its height,
// null while it has no size.
export function fillParent(renderer: WebGLRenderer): number | null {
  const canvas = renderer.domElement;
  const { clientWidth, clientHeight } = canvas.parentElement ?? canvas;
  if (clientWidth === 0 || clientHeight === 0) return null;
  renderer.setSize(clientWidth, clientHeight, false);
  return clientWidth / clientHeight;
}
