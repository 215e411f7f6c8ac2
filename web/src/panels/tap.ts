// Clicks on the image, by mouse or finger, that do not turn the view.

const farthest_px = 6; // one that moves further does

// `tapped` is told where, in pixels of the page, while the page is there; true: the tap is for
// nobody else. The second click of a double click is none.
export function onTap(
  canvas: HTMLCanvasElement,
  tapped: (x_px: number, y_px: number) => boolean | void,
): void {
  let down: readonly [number, number] | null = null;
  canvas.addEventListener('pointerdown', (event) => {
    down = [event.clientX, event.clientY];
  });
  canvas.addEventListener('click', (event) => {
    if (
      event.detail > 1 ||
      !down ||
      Math.hypot(event.clientX - down[0], event.clientY - down[1]) > farthest_px
    )
      return;
    if (tapped(event.clientX, event.clientY)) event.stopImmediatePropagation();
  });
}
