// How shaders show how well a place was seen: the same on points and on the surface. Orange and
// blue look different to everybody; stripes say it without colours.
import { goodConfidence, lowConfidence } from '../state/coverage';

export const coverageDefines = { COVERAGE_LOW: lowConfidence, COVERAGE_GOOD: goodConfidence };

export const coverageShader = /* glsl */ `
bool needsAnotherLook(float confidence) { return confidence < float(COVERAGE_LOW); }

vec3 coverageColor(float confidence) {  // sRGB
  if (needsAnotherLook(confidence)) return vec3(0.90, 0.62, 0.0);
  return confidence < float(COVERAGE_GOOD) ? vec3(0.50, 0.78, 0.95) : vec3(0.0, 0.40, 0.66);
}

// What an sRGB colour is multiplied with at this place of the image.
float stripe(vec2 at_px) { return mod(at_px.x + at_px.y, 12.0) < 4.0 ? 0.4 : 1.0; }
`;
