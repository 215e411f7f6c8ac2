// A surface in its own colours, lit softly from above and from the eye so that its shape is seen:
// what faces the eye keeps its colour as it is. Seen from behind it is dim, and with `veil` as good
// as through, so that a room can be looked into from outside.
import { BackSide, Color, FrontSide, ShaderMaterial, type DataTexture, type Texture } from 'three';
import { meshColors } from '../state/view_options';
import { coverageDefines, coverageShader } from './coverage_shader';
import { hiddenShader, nothingHidden, type HiddenUniforms } from './hidden_parts';

export const coverageMode = meshColors.length; // only where vertices have confidences

const vertexShader = /* glsl */ `
#ifdef HAS_COLOR
attribute vec4 color;  // what has three components gets a fourth one
#endif
#ifdef HAS_MAP
varying vec2 vUv;
#endif
#ifdef HAS_POSES
attribute float row;  // of the submap that it moves with
uniform highp sampler2D poses;
flat varying float vFaded;
#endif
#ifdef HAS_CONFIDENCE
varying float vConfidence;
#endif
varying vec3 vColor, vNormal, vInView, vInScene;

void main() {
  vec4 inWorld = vec4(position, 1.0);
  vec3 facing = normal;
#ifdef HAS_POSES
  int at = int(row + 0.5);
  vec4 x = texelFetch(poses, ivec2(0, at), 0);
  vec4 y = texelFetch(poses, ivec2(1, at), 0);
  vec4 z = texelFetch(poses, ivec2(2, at), 0);
  inWorld = vec4(dot(x, inWorld), dot(y, inWorld), dot(z, inWorld), 1.0);
  facing = vec3(dot(x.xyz, facing), dot(y.xyz, facing), dot(z.xyz, facing));
  vFaded = texelFetch(poses, ivec2(3, at), 0).x;
#endif
#ifdef HAS_MAP
  vUv = uv;
#endif
#ifdef HAS_COLOR
#ifdef SRGB_COLOR
  vColor = mix(pow((color.rgb + 0.055) / 1.055, vec3(2.4)), color.rgb / 12.92,
    vec3(lessThanEqual(color.rgb, vec3(0.04045))));
#else
  vColor = color.rgb;
#endif
#else
  vColor = vec3(1.0);
#endif
#ifdef HAS_CONFIDENCE
  vConfidence = color.a * 255.0 / 8.0;
#endif
  vNormal = normalMatrix * facing;
  vec4 inView = modelViewMatrix * inWorld;
  vInView = inView.xyz;
  vInScene = (modelMatrix * inWorld).xyz;
  gl_Position = projectionMatrix * inView;
}`;

const fragmentShader = /* glsl */ `
uniform sampler2D map;
uniform vec3 tint;  // linear
uniform int colorMode;  // 0 shaded, 1 as it is, 2 normals, COVERAGE
uniform bool back, veil;
#ifdef HAS_POSES
flat varying float vFaded;  // 1: of a part of the map that the camera is not in
#endif
#ifdef HAS_MAP
varying vec2 vUv;
#endif
#ifdef HAS_CONFIDENCE
varying float vConfidence;
#endif
varying vec3 vColor, vNormal, vInView, vInScene;

void main() {
  if (isHidden(vec4(vInScene, 1.0))) discard;
  vec3 base = vColor;
#ifdef HAS_MAP
  base = texture2D(map, vUv).rgb;
#endif
  base *= tint;
#ifdef HAS_CONFIDENCE
  if (colorMode == COVERAGE) base = sRGBTransferEOTF(vec4(coverageColor(vConfidence), 1.0)).rgb;
#endif
  vec3 normal = normalize(vNormal);
  vec3 eye = normalize(-vInView);
  float facing = abs(dot(normal, eye));
  vec3 up = normalize((viewMatrix * vec4(0.0, -1.0, 0.0, 0.0)).xyz);  // y points down in the world
  float sky = 0.5 + 0.5 * dot(back ? -normal : normal, up);
  float light = 1.0;
  if (colorMode == 0 || colorMode == COVERAGE)
    light = (0.56 + 0.44 * facing) * (0.86 + 0.14 * sky) + 0.04;
  vec3 shown = base * light;
  if (colorMode == 2) {
    vec3 world = inverseTransformDirection(normal, viewMatrix);
    vec3 color = world * vec3(0.5, -0.5, -0.5) + 0.5;  // as points have it
    shown = color * color;
  }
  float alpha = 1.0;
  if (back) {
    float grey = dot(shown, vec3(0.2126, 0.7152, 0.0722));
    shown = mix(vec3(grey), shown, 0.35) * 0.42 + vec3(0.014, 0.016, 0.020);
    if (veil) alpha = 0.2 + 0.4 * (1.0 - facing);  // its outline stays
  }
#ifdef HAS_POSES
  if (vFaded > 0.5) shown = mix(vec3(0.022, 0.027, 0.040), shown, 0.35);
#endif
  gl_FragColor = vec4(shown, alpha);
  #include <colorspace_fragment>
#ifdef HAS_CONFIDENCE
  if (colorMode == COVERAGE && needsAnotherLook(vConfidence))
    gl_FragColor.rgb *= stripe(gl_FragCoord.xy);
#endif
}`;

export interface MeshLook {
  readonly colorMode: number;
  readonly veil: boolean;
}

export interface MeshMaterialKind {
  readonly back: boolean;
  readonly map: Texture | null;
  readonly color: 'none' | 'linear' | 'srgb'; // of the vertices
  readonly tint?: Color; // linear, of everything
  // The vertices have confidences in the alpha of their colours: eighths, as a share of 255.
  readonly confidences?: boolean;
  // Of the submaps (PoseTexture), where vertices have rows of it.
  readonly poses?: { value: DataTexture };
  readonly hidden?: HiddenUniforms;
}

export class MeshMaterial extends ShaderMaterial {
  constructor({
    back,
    map,
    color,
    tint = new Color(1, 1, 1),
    confidences = false,
    poses,
    hidden = nothingHidden,
  }: MeshMaterialKind) {
    super({
      vertexShader,
      fragmentShader: `#include <common>\n${hiddenShader}\n${coverageShader}\n${fragmentShader}`,
      side: back ? BackSide : FrontSide,
      transparent: back,
      defines: {
        ...(color !== 'none' ? { HAS_COLOR: '' } : {}),
        ...(color === 'srgb' ? { SRGB_COLOR: '' } : {}),
        ...(map ? { HAS_MAP: '' } : {}),
        COVERAGE: coverageMode,
        ...coverageDefines,
        ...(confidences ? { HAS_CONFIDENCE: '' } : {}),
        ...(poses ? { HAS_POSES: '' } : {}),
      },
      uniforms: {
        ...hidden,
        map: { value: map },
        tint: { value: tint },
        colorMode: { value: 0 },
        back: { value: back },
        veil: { value: true },
        ...(poses ? { poses } : {}),
      },
    });
  }

  show(look: MeshLook): void {
    this.uniforms['colorMode']!.value = look.colorMode;
    this.uniforms['veil']!.value = look.veil;
    if (this.side === BackSide) this.depthWrite = !look.veil;
  }
}
