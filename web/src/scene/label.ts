// Text in the image: upright and of the same size from everywhere, above the point where it stands,
// and never hidden. At the edges of the image it moves aside, as far as it has to be read whole,
// and fades as its point leaves the image.
import { CanvasTexture, Sprite, SpriteMaterial, SRGBColorSpace, Vector3, type Camera } from 'three';
import type { ViewSize } from './layer';

const height_px = 26; // on the screen, at a device pixel ratio of 1
const oversampling = 2; // of the texture: sharp on fine screens
const font = `500 ${13 * oversampling}px system-ui, 'Segoe UI', Roboto, 'Noto Sans', sans-serif`;
const padding_px = 10;
const margin_px = 6; // to the edges of the image
const fading = 0.04; // of half of the image: so near at an edge its point leaves it

export class Label {
  readonly object = new Sprite(
    new SpriteMaterial({ sizeAttenuation: false, depthTest: false, transparent: true }),
  );
  private text = '';
  private aspect = 1;
  private perPixel = 0.001; // height of a pixel on the screen, at a distance of 1

  // `above`: how far it is from its point, in heights of it.
  constructor(
    private readonly color: string,
    private readonly above = 0.3,
  ) {
    this.object.onBeforeRender = (_renderer, _scene, camera) => this.keepInside(camera);
    this.object.renderOrder = 10;
    this.object.visible = false;
  }

  // Empty text: none.
  say(text: string): void {
    if (text !== this.text && text !== '') this.write(text);
    this.text = text;
    this.object.visible = text !== '';
  }

  resize(size: ViewSize): void {
    const ratio = Math.min(globalThis.devicePixelRatio ?? 1, 2); // as the renderer has it
    this.perPixel = (2 * Math.tan(size.verticalFov_rad / 2) * ratio) / size.height_px;
    this.scale();
  }

  dispose(): void {
    this.object.material.map?.dispose();
    this.object.material.dispose();
  }

  private keepInside(camera: Camera): void {
    const { object, perPixel } = this;
    const { x, y } = new Vector3().setFromMatrixPosition(object.matrixWorld).project(camera);
    // The projection leads from lengths at a distance of 1 to halves of the image.
    const [across = 1, , , , , up = 1] = camera.projectionMatrix.elements;
    const margin = margin_px * perPixel;
    object.center.set(
      anchored(0.5, x, object.scale.x * across, 1 - margin * across),
      anchored(-this.above, y, object.scale.y * up, 1 - margin * up),
    );
    object.material.opacity = Math.min(
      1,
      Math.max(0, (1 - Math.max(Math.abs(x), Math.abs(y))) / fading),
    );
  }

  private write(text: string): void {
    const canvas = document.createElement('canvas');
    const brush = canvas.getContext('2d')!;
    brush.font = font;
    canvas.width = Math.ceil(brush.measureText(text).width) + 2 * padding_px * oversampling;
    canvas.height = height_px * oversampling;
    brush.fillStyle = 'rgb(22 26 31 / 0.88)';
    brush.beginPath();
    brush.roundRect(0, 0, canvas.width, canvas.height, 7 * oversampling);
    brush.fill();
    brush.font = font; // a canvas of another size forgets it
    brush.fillStyle = this.color;
    brush.textBaseline = 'middle';
    brush.fillText(text, padding_px * oversampling, canvas.height / 2);
    const texture = new CanvasTexture(canvas);
    texture.colorSpace = SRGBColorSpace;
    this.object.material.map?.dispose();
    this.object.material.map = texture;
    this.object.material.needsUpdate = true;
    this.aspect = canvas.width / canvas.height;
    this.scale();
  }

  private scale(): void {
    const height = height_px * this.perPixel;
    this.object.scale.set(height * this.aspect, height, 1);
  }
}

// Where on it something stands at `at`, as a share of its size, so that all of it is between -edge
// and edge: `usual`, if it can be. What is too large begins at -edge.
export function anchored(usual: number, at: number, size: number, edge: number): number {
  return Math.min(Math.max(usual, 1 - (edge - at) / size), (at + edge) / size);
}
