// Notes in the image: a pin with a number at each of them, upright and of the same size from
// everywhere, in front of everything. The chosen one has its text.
import { CanvasTexture, Group, Sprite, SpriteMaterial, SRGBColorSpace } from 'three';
import type { Place } from '../connection/measurements';
import { Label } from './label';
import type { Layer, ViewSize } from './layer';

const width_px = 28; // on the screen, at a device pixel ratio of 1
const height_px = 36;
const oversampling = 2; // of the texture: sharp on fine screens
const font = `600 ${13 * oversampling}px system-ui, 'Segoe UI', Roboto, 'Noto Sans', sans-serif`;
const [plain, chosen] = [0xffffff, 0xffb482]; // over white paper, dark edges and numbers
const text_chars = 48;

export interface NotePin {
  readonly position_m: Place; // of its tip, in the world of the scan
  readonly number: number;
  readonly text: string; // empty: none beside it
}

const middle_px = 22; // of a pin above its tip, and as far as from there to whoever taps beside it

type OnScreen = readonly [number, number]; // pixels of the page
type TextLabel = Pick<Label, 'object' | 'say' | 'resize' | 'dispose'>;
type Paint = (number: number) => CanvasTexture;

export class NoteLayer implements Layer {
  readonly object = new Group();
  private readonly pins: Sprite[] = [];
  private readonly textures = new Map<number, CanvasTexture>();
  private readonly text: TextLabel;
  private perPixel = 0.001; // height of a pixel on the screen, at a distance of 1

  constructor(
    makeLabel: () => TextLabel = () => new Label('#ffffff', (height_px + 6) / 26), // above the pin
    private readonly paint: Paint = painted,
  ) {
    this.text = makeLabel();
    this.text.object.renderOrder = 13;
    this.object.add(this.text.object);
  }

  show(pins: readonly NotePin[]): void {
    while (this.pins.length > pins.length) this.drop(this.pins.pop()!);
    while (this.pins.length < pins.length) this.pins.push(this.made());
    pins.forEach(({ position_m, number, text }, i) => {
      const pin = this.pins[i]!;
      pin.position.set(...position_m);
      pin.renderOrder = text === '' ? 11 : 12;
      pin.material.color.setHex(text === '' ? plain : chosen);
      const map = this.textureOf(number);
      if (pin.material.map !== map) {
        pin.material.map = map;
        pin.material.needsUpdate = true;
      }
    });
    const labelled = pins.find(({ text }) => text !== '');
    if (labelled) this.text.object.position.set(...labelled.position_m);
    this.text.say(labelled ? shortened(labelled.text) : '');
  }

  onResize(size: ViewSize): void {
    const ratio = Math.min(globalThis.devicePixelRatio ?? 1, 2); // as the renderer has it
    this.perPixel = (2 * Math.tan(size.verticalFov_rad / 2) * ratio) / size.height_px;
    this.text.resize(size);
    for (const pin of this.pins) this.scale(pin);
  }

  dispose(): void {
    for (const pin of this.pins) this.drop(pin);
    for (const texture of this.textures.values()) texture.dispose();
    this.text.dispose();
  }

  private made(): Sprite {
    const pin = new Sprite(
      new SpriteMaterial({ sizeAttenuation: false, depthTest: false, transparent: true }),
    );
    pin.center.set(0.5, 0);
    this.scale(pin);
    this.object.add(pin);
    return pin;
  }

  private scale(pin: Sprite): void {
    pin.scale.set(width_px * this.perPixel, height_px * this.perPixel, 1);
  }

  private drop(pin: Sprite): void {
    pin.removeFromParent();
    pin.material.dispose();
  }

  private textureOf(number: number): CanvasTexture {
    const known = this.textures.get(number);
    if (known) return known;
    const made = this.paint(number);
    this.textures.set(number, made);
    return made;
  }
}

// Returns the index of the pin at this point of the page; null: there is none. `screenOf`:
// where a place is on the page.
export function pinAt(
  pins: readonly NotePin[],
  [x_px, y_px]: OnScreen,
  screenOf: (place: Place) => OnScreen | null,
): number | null {
  const away_px = pins.map(({ position_m }) => {
    const [x, y] = screenOf(position_m) ?? [Infinity, Infinity];
    return Math.hypot(x - x_px, y - middle_px - y_px);
  });
  const nearest = away_px.indexOf(Math.min(...away_px));
  return nearest >= 0 && away_px[nearest]! <= middle_px ? nearest : null;
}

// The first line, or what of it has room beside a pin.
export function shortened(text: string): string {
  const [line = ''] = text.split('\n');
  const chars = [...line];
  if (chars.length > text_chars) return `${chars.slice(0, text_chars).join('').trimEnd()} …`;
  return line === text ? line : `${line} …`;
}

function painted(number: number): CanvasTexture {
  const canvas = document.createElement('canvas');
  const [width, height] = [width_px * oversampling, height_px * oversampling];
  canvas.width = width;
  canvas.height = height;
  const brush = canvas.getContext('2d')!;
  const [middle, radius] = [width / 2, width / 2 - 3];
  brush.beginPath(); // a circle with a tip below
  brush.arc(middle, middle, radius, 0.8 * Math.PI, 0.2 * Math.PI);
  brush.lineTo(middle, height - 3);
  brush.closePath();
  brush.fillStyle = '#ffffff';
  brush.strokeStyle = '#16191d';
  brush.lineWidth = 2 * oversampling;
  brush.lineJoin = 'round';
  brush.fill();
  brush.stroke();
  brush.font = font;
  brush.fillStyle = '#16191d';
  brush.textAlign = 'center';
  brush.textBaseline = 'middle';
  brush.fillText(String(number), middle, middle + oversampling / 2, 2 * radius - 3 * oversampling);
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  return texture;
}
