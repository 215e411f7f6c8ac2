// Clicks on the picture, by mouse or finger, that do not turn the view.

const farthest_px = 6; // one that moves further does

// `tapped` is told where, in pixels of the page, while the page is there.
export function onTap(canvas: HTMLCanvasElement, tapped: (x_px: number, y_px: number) => void): void {
  let down: readonly [number, number] | null = null;
  canvas.addEventListener('pointerdown', (event) => {
    down = [event.clientX, event.clientY];
  });
  canvas.addEventListener('click', (event) => {
    if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) <= farthest_px) tapped(event.clientX, event.clientY);
  });
}
