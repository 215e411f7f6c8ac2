// Eye-dome lighting (Boucheny, as Potree has it): a point is darker the further it lies behind its
// neighbours in the image, so that edges and shapes are seen without normals. Points are drawn into
// an image of their own, which then stands in the scene with its depth.
import {
  DepthTexture,
  Mesh,
  NearestFilter,
  PerspectiveCamera,
  PlaneGeometry,
  ShaderMaterial,
  UnsignedIntType,
  Vector2,
  WebGLRenderTarget,
  type Object3D,
  type Scene,
  type WebGLRenderer,
} from 'three';
import type { Layer, ViewSize } from './layer';

const ofPoints = 1; // of three's layers, what is drawn on its own
const radius_px = 1.4; // at a device pixel ratio of 1
const strength = 30;
const darkest = 0.35;

const vertexShader = /* glsl */ `
varying vec2 vUv;
void main() {
  vUv = uv;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const fragmentShader = /* glsl */ `
uniform sampler2D colors;
uniform highp sampler2D depths;
uniform vec2 reach;  // to the neighbours
uniform float near, far, strength, darkest;
varying vec2 vUv;

float logOf(float depth) {
  return log2(near * far / (far - depth * (far - near)));
}

void main() {
  float depth = texture2D(depths, vUv).x;
  if (depth >= 1.0) discard;
  float here = logOf(depth);
  float behind = 0.0;
  for (int i = 0; i < 8; ++i) {
    float angle = float(i) * 0.7853982;
    float other = texture2D(depths, vUv + reach * vec2(cos(angle), sin(angle))).x;
    if (other < 1.0) behind += max(0.0, here - logOf(other));
  }
  float shade = max(darkest, exp(-strength * behind / 8.0));
  gl_FragDepth = depth;
  gl_FragColor = vec4(texture2D(colors, vUv).rgb * shade, 1.0);
}`;

export class EyeDome implements Layer {
  readonly object: Mesh<PlaneGeometry, ShaderMaterial>;
  private readonly target = new WebGLRenderTarget(1, 1, {
    minFilter: NearestFilter,
    magFilter: NearestFilter,
    depthTexture: new DepthTexture(1, 1, UnsignedIntType),
  });
  private readonly reach = new Vector2();

  constructor() {
    const uniforms = {
      colors: { value: this.target.texture },
      depths: { value: this.target.depthTexture },
      reach: { value: this.reach },
      near: { value: 1 },
      far: { value: 2 },
      strength: { value: strength },
      darkest: { value: darkest },
    };
    this.object = new Mesh(
      new PlaneGeometry(2, 2),
      new ShaderMaterial({ vertexShader, fragmentShader, uniforms }),
    );
    this.object.frustumCulled = false;
    this.object.visible = false;
  }

  onResize({ width_px, height_px }: ViewSize): void {
    const ratio = Math.min(globalThis.devicePixelRatio ?? 1, 2); // as the renderer has it
    this.target.setSize(width_px, height_px);
    this.reach.set((radius_px * ratio) / width_px, (radius_px * ratio) / height_px);
  }

  // All of the scene, with the points in it as they are, or lit.
  draw(
    renderer: WebGLRenderer,
    scene: Scene,
    camera: PerspectiveCamera,
    points: Object3D,
    lit: boolean,
  ): void {
    this.object.visible = false;
    if (!lit) {
      camera.layers.enable(ofPoints);
      renderer.render(scene, camera);
      return;
    }
    points.traverse((object) => object.layers.set(ofPoints));
    camera.layers.set(ofPoints);
    renderer.setRenderTarget(this.target);
    renderer.render(scene, camera);
    renderer.setRenderTarget(null);
    const { near, far } = this.object.material.uniforms;
    near!.value = camera.near;
    far!.value = camera.far;
    this.object.visible = true;
    camera.layers.set(0);
    renderer.render(scene, camera);
  }

  dispose(): void {
    this.target.depthTexture?.dispose();
    this.target.dispose();
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}
