// Round points with a size in metres, coloured by what the viewer asks for.
import { ShaderMaterial } from 'three';
import { colorModes, type ViewOptions } from '../state/view_options';
import type { ViewSize } from './layer';

const vertexShader = /* glsl */ `
attribute vec4 pointColor;  // rgb and confidence * 8 / 255
uniform float pointSize_m;
uniform float pixelsPerMetre;  // at a distance of one metre
uniform int colorMode;
uniform bool hideBacks;
uniform bool faded;
varying vec3 vColor;
varying float vRound;  // discs would tear holes into surfaces of very small points

vec3 confidenceColor(float confidence) {
  vec3 low = vec3(0.24, 0.16, 0.42), middle = vec3(0.16, 0.57, 0.55), high = vec3(0.95, 0.88, 0.45);
  return confidence < 0.5 ? mix(low, middle, confidence * 2.0) : mix(middle, high, confidence * 2.0 - 1.0);
}

void main() {
  vec4 inView = modelViewMatrix * vec4(position, 1.0);
  vec3 normalInView = mat3(modelViewMatrix) * normal;
  bool hasNormal = dot(normal, normal) > 0.1;
  if (hideBacks && hasNormal && dot(normalInView, inView.xyz) > 0.0) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // outside of the view
    gl_PointSize = 0.0;
    return;
  }
  if (colorMode == 0) vColor = pointColor.rgb;
  else if (colorMode == 1) vColor = hasNormal ? mat3(modelMatrix) * normal * vec3(0.5, -0.5, -0.5) + 0.5 : vec3(0.4);
  else vColor = confidenceColor(min(pointColor.a * 255.0 / 160.0, 1.0));
  if (faded) vColor = mix(vec3(0.16, 0.18, 0.22), vColor, 0.35);
  gl_Position = projectionMatrix * inView;
  gl_PointSize = clamp(pointSize_m * pixelsPerMetre / -inView.z, 2.0, 64.0);
  vRound = step(5.0, gl_PointSize);
}`;

const fragmentShader = /* glsl */ `
varying vec3 vColor;
varying float vRound;

void main() {
  vec2 offset = gl_PointCoord - 0.5;
  if (vRound * dot(offset, offset) > 0.25) discard;
  gl_FragColor = vec4(vColor, 1.0);
}`;

export class PointsMaterial extends ShaderMaterial {
  // `faded`: of a part of the map that the camera is not in.
  constructor({ faded }: { readonly faded: boolean }) {
    super({
      vertexShader,
      fragmentShader,
      uniforms: {
        pointSize_m: { value: 0.008 },
        pixelsPerMetre: { value: 800 },
        colorMode: { value: 0 },
        hideBacks: { value: true },
        faded: { value: faded },
      },
    });
  }

  show(options: ViewOptions): void {
    this.uniforms['pointSize_m']!.value = options.pointSize_mm / 1000;
    this.uniforms['colorMode']!.value = colorModes.indexOf(options.color);
    this.uniforms['hideBacks']!.value = options.hideBacks;
  }

  resize(size: ViewSize): void {
    this.uniforms['pixelsPerMetre']!.value = size.height_px / (2 * Math.tan(size.verticalFov_rad / 2));
  }
}
