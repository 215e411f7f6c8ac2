// An image of a frame, or why there is none.
import { element, setText } from './dom';

export interface FrameImage {
  readonly element: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  isThere(): boolean;
  show(image: ImageBitmap | string): void; // text: instead of an image, which is used up
}

export function frameImage(name: string, ...caption: (Node | string)[]): FrameImage {
  const canvas = element('canvas', { class: 'frame-image', role: 'img', 'aria-label': name });
  const why = element('p', { class: 'frame-why' });
  const node = element(
    'figure',
    { class: 'frame-picture' },
    element('div', {}, canvas, why),
    element('figcaption', {}, ...caption),
  );
  let there = false;
  return {
    element: node,
    canvas,
    isThere: () => there,
    show(image) {
      there = typeof image !== 'string';
      canvas.classList.toggle('missing', !there);
      why.hidden = there;
      if (typeof image === 'string') {
        setText(why, image);
        return;
      }
      // Setting the size clears it, even to the same one.
      if (canvas.width !== image.width || canvas.height !== image.height)
        [canvas.width, canvas.height] = [image.width, image.height];
      canvas.getContext('2d')!.drawImage(image, 0, 0);
      image.close();
    },
  };
}
