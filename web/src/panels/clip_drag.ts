// Faces of the clip box follow the mouse or a finger. Whoever drags one does not turn the view.
import type { ScanScene } from '../scene/scene';
import type { Cutting, CuttingEvent, Face } from '../state/cutting';
import type { Store } from '../state/store';

// From the middle of a handle: a thumb needs 44 across.
const reach_px = { mouse: 12, other: 22 } as const;

interface Drag {
  readonly pointer: number;
  readonly face: Face;
  readonly from_m: number; // where the face was
  readonly grip_m: number; // and where it was taken hold of
}

// `stage`: around the canvas, so that it hears of everything first.
export function clipDrag(
  stage: HTMLElement,
  canvas: HTMLCanvasElement,
  scene: ScanScene,
  store: Store<Cutting, CuttingEvent>,
): () => void {
  let drag: Drag | null = null;
  let swallowClick = false;
  const ended = new AbortController();
  const faceAt = (event: PointerEvent): Face | null =>
    store.get().active && store.get().clip
      ? scene.handleAt(
          event.clientX,
          event.clientY,
          event.pointerType === 'mouse' ? reach_px.mouse : reach_px.other,
        )
      : null;
  const begin = (event: PointerEvent): void => {
    swallowClick = drag !== null; // a second finger is for nobody
    if (!drag && event.button === 0) {
      const face = faceAt(event);
      const box = store.get().clip;
      const grip_m = face && scene.dragged(face, event.clientX, event.clientY);
      if (!face || !box || grip_m === null) return;
      drag = { pointer: event.pointerId, face, from_m: box[face.side][face.axis], grip_m };
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true });
      swallowClick = true;
    }
    if (drag) event.stopPropagation();
  };
  const move = (event: PointerEvent): void => {
    if (!drag) {
      if (event.pointerType === 'mouse' && event.buttons === 0)
        canvas.classList.toggle('on-handle', faceAt(event) !== null);
      return;
    }
    event.stopPropagation();
    if (event.pointerId !== drag.pointer) return;
    const at_m = scene.dragged(drag.face, event.clientX, event.clientY);
    if (at_m !== null)
      store.dispatch({ kind: 'face', face: drag.face, to_m: drag.from_m + at_m - drag.grip_m });
  };
  const end = (event: PointerEvent): void => {
    if (!drag) return;
    event.stopPropagation();
    if (event.pointerId === drag.pointer) drag = null;
  };
  const click = (event: MouseEvent): void => {
    if (swallowClick) event.stopPropagation();
  };
  const options = { capture: true, signal: ended.signal };
  stage.addEventListener('pointerdown', begin, options);
  stage.addEventListener('pointermove', move, options);
  for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'] as const)
    stage.addEventListener(name, end, options);
  for (const name of ['click', 'dblclick'] as const) stage.addEventListener(name, click, options);
  // Where the image is another one, what was taken hold of is elsewhere.
  window.addEventListener('resize', () => (drag = null), { signal: ended.signal });
  return () => ended.abort();
}
