// Points as discs that lie in the surface, each as large as its neighbours are far, coloured by
// what the viewer asks for. Where discs overlap a pixel belongs to the one whose middle is nearest.
import { ShaderMaterial, type DataTexture } from 'three';
import { colorModes, type ViewOptions } from '../state/view_options';
import { coverageDefines, coverageShader } from './coverage_shader';
import { hiddenShader, nothingHidden, type HiddenUniforms } from './hidden_parts';
import type { ViewSize } from './layer';

const coverageMode = colorModes.length;

const vertexShader = /* glsl */ `
attribute vec4 pointColor;  // rgb and confidence * 8 / 255
attribute float radius;  // metres; 0: nothing is there
attribute float row;  // of its submap
uniform highp sampler2D poses;
uniform float sizeFactor, leastRadius;
uniform float pixelsPerMetre;  // at a distance of one metre
uniform int colorMode;
uniform bool hideBacks;
flat varying vec3 vColor, vCenter, vNormal;  // in the view
flat varying float vRadius, vSize_px, vStriped;

vec3 confidenceColor(float confidence) {
  vec3 low = vec3(0.24, 0.16, 0.42), middle = vec3(0.16, 0.57, 0.55), high = vec3(0.95, 0.88, 0.45);
  float at = confidence * 2.0;
  return at < 1.0 ? mix(low, middle, at) : mix(middle, high, at - 1.0);
}

void main() {
  int at = int(row + 0.5);
  vec4 x = texelFetch(poses, ivec2(0, at), 0);
  vec4 y = texelFetch(poses, ivec2(1, at), 0);
  vec4 z = texelFetch(poses, ivec2(2, at), 0);
  bool faded = texelFetch(poses, ivec2(3, at), 0).x > 0.5;
  vec4 inSubmap = vec4(position, 1.0);
  vec4 atWorld = vec4(dot(x, inSubmap), dot(y, inSubmap), dot(z, inSubmap), 1.0);
  vec4 inView = modelViewMatrix * atWorld;
  bool hidden = isHidden(modelMatrix * atWorld);
  vec3 inWorld = vec3(dot(x.xyz, normal), dot(y.xyz, normal), dot(z.xyz, normal));
  bool hasNormal = dot(normal, normal) > 0.1;
  vec3 toEye = -normalize(inView.xyz);
  vec3 inViewNormal = hasNormal ? normalize(mat3(modelViewMatrix) * inWorld) : toEye;
  float facing = dot(inViewNormal, toEye);
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // outside of the view
  gl_PointSize = 0.0;
  if (hidden || radius <= 0.0 || inView.z > -1e-4 || (hideBacks && facing < 0.0)) return;

  if (facing < 0.0) inViewNormal = -inViewNormal;
  // Seen from its edge a disc would be nothing, and what is behind would shine through.
  vNormal = normalize(inViewNormal + max(0.0, 0.2 - abs(facing)) * toEye);
  vec3 shown = pointColor.rgb;
  float confidence = pointColor.a * 255.0 / 8.0;
  vStriped = colorMode == COVERAGE && needsAnotherLook(confidence) ? 1.0 : 0.0;
  if (colorMode == COVERAGE) shown = coverageColor(confidence);
  if (colorMode == 0 || colorMode == COVERAGE) {
    vec3 up = mat3(viewMatrix) * vec3(0.0, -1.0, 0.0);  // y points down in the world
    float sky = 0.5 + 0.5 * dot(inViewNormal, up);
    float light = (0.56 + 0.44 * abs(facing)) * (0.86 + 0.14 * sky) + 0.04;
    shown = pow(pow(shown, vec3(2.2)) * light, vec3(1.0 / 2.2));  // as surfaces have it
  } else if (colorMode == 2) {
    shown = hasNormal ? mat3(modelMatrix) * inWorld * vec3(0.5, -0.5, -0.5) + 0.5 : vec3(0.4);
  } else if (colorMode == 3) {
    shown = confidenceColor(min(confidence / 20.0, 1.0));
  }
  vColor = faded ? mix(vec3(0.16, 0.18, 0.22), shown, 0.35) : shown;
  vCenter = inView.xyz;
  vRadius = max(radius, leastRadius) * sizeFactor;
  gl_Position = projectionMatrix * inView;
  vSize_px = clamp(2.1 * vRadius * pixelsPerMetre / -inView.z, 2.0, 256.0);
  gl_PointSize = vSize_px;
}`;

const fragmentShader = /* glsl */ `
uniform float pixelsPerMetre;
uniform mat4 projectionMatrix;
flat varying vec3 vColor, vCenter, vNormal;
flat varying float vRadius, vSize_px, vStriped;

void main() {
  vec2 offset_px = (gl_PointCoord - 0.5) * vSize_px;
  float depth_m = -vCenter.z;
  // Small ones are squares: discs would tear holes.
  if (vSize_px > 5.0) {
    vec3 ray = vec3(vCenter.xy / depth_m + vec2(offset_px.x, -offset_px.y) / pixelsPerMetre, -1.0);
    float along = dot(vNormal, vCenter) / dot(vNormal, ray);
    vec3 away = ray * along - vCenter;
    float share = dot(away, away) / (vRadius * vRadius);
    if (share > 1.0 || along <= 0.0) discard;
    depth_m = along + share * vRadius * 0.5;
  }
  float depth = (projectionMatrix[2][2] * -depth_m + projectionMatrix[3][2]) / depth_m;
  gl_FragDepth = 0.5 * depth + 0.5;
  gl_FragColor = vec4(vStriped > 0.5 ? vColor * stripe(gl_FragCoord.xy) : vColor, 1.0);
}`;

export class PointsMaterial extends ShaderMaterial {
  // `poses`: of the submaps (PoseTexture).
  constructor(poses: { value: DataTexture }, hidden: HiddenUniforms = nothingHidden) {
    super({
      vertexShader: `${hiddenShader}\n${coverageShader}\n${vertexShader}`,
      fragmentShader: `${coverageShader}\n${fragmentShader}`,
      defines: { COVERAGE: coverageMode, ...coverageDefines },
      uniforms: {
        poses,
        ...hidden,
        sizeFactor: { value: 1 },
        leastRadius: { value: 0 },
        pixelsPerMetre: { value: 800 },
        colorMode: { value: 0 },
        hideBacks: { value: true },
      },
    });
  }

  show(options: ViewOptions): void {
    this.uniforms['sizeFactor']!.value = options.pointSize_percent / 100;
    this.uniforms['colorMode']!.value = options.coverage
      ? coverageMode
      : colorModes.indexOf(options.color);
    this.uniforms['hideBacks']!.value = options.hideBacks;
  }

  // Of all discs, in metres.
  enlarge(leastRadius_m: number): void {
    this.uniforms['leastRadius']!.value = leastRadius_m;
  }

  resize(size: ViewSize): void {
    this.uniforms['pixelsPerMetre']!.value =
      size.height_px / (2 * Math.tan(size.verticalFov_rad / 2));
  }
}
