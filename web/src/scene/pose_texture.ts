// Where the submaps stand, as a texture: shaders look a point's submap up there, so that points of
// many submaps are drawn in one call and a correction touches none of them.
import { DataTexture, FloatType, Matrix4, NearestFilter, RGBAFormat } from 'three';

const firstRows = 64;
const texels = 4; // of a row: three rows of the matrix, and whether it is faded
const none = new Matrix4();

export class PoseTexture {
  // Materials share it.
  readonly uniform: { value: DataTexture } = { value: textureOf(firstRows) };
  private readonly rows = new Map<number, number>();

  // Of a submap; it stands where the world begins until it is told otherwise.
  rowOf(submap: number): number {
    let row = this.rows.get(submap);
    if (row === undefined) {
      row = this.rows.size;
      this.rows.set(submap, row);
      if (row >= this.uniform.value.image.height) this.grow();
      this.write(row, none, false);
    }
    return row;
  }

  set(submap: number, worldFromSubmap: Matrix4, faded: boolean): void {
    this.write(this.rowOf(submap), worldFromSubmap, faded);
  }

  isFaded(submap: number): boolean {
    return this.data[(this.rowOf(submap) * texels + 3) * 4] === 1;
  }

  dispose(): void {
    this.uniform.value.dispose();
  }

  private get data(): Float32Array {
    return this.uniform.value.image.data as unknown as Float32Array;
  }

  private write(row: number, { elements }: Matrix4, faded: boolean): void {
    const { data } = this;
    const values = [0, 1, 2].flatMap((i) => [
      elements[i]!,
      elements[4 + i]!,
      elements[8 + i]!,
      elements[12 + i]!,
    ]);
    values.push(faded ? 1 : 0, 0, 0, 0);
    values.forEach((value, i) => (data[row * texels * 4 + i] = value));
    this.uniform.value.needsUpdate = true;
  }

  private grow(): void {
    const larger = textureOf(2 * this.uniform.value.image.height);
    (larger.image.data as unknown as Float32Array).set(this.data);
    this.uniform.value.dispose();
    this.uniform.value = larger;
  }
}

function textureOf(rows: number): DataTexture {
  const texture = new DataTexture(
    new Float32Array(rows * texels * 4),
    texels,
    rows,
    RGBAFormat,
    FloatType,
  );
  texture.minFilter = texture.magFilter = NearestFilter;
  return texture;
}
