#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Packs the frame's grey image and its Sobel gradient in grey values per pixel; zero on the border.
#include "shaders/shared/frame.h"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
TEXELS(0, intensity);
layout(scalar, binding = 1) writeonly buffer Image { GreyAndGradient image[]; };
PARAMETERS(GradientParams, p);

void main() {
  uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= p.width || pixel.y >= p.height) return;
  uint i = pixel.y * p.width + pixel.x;
  vec2 g = vec2(0.0);
  if (pixel.x > 0u && pixel.y > 0u && pixel.x + 1u < p.width && pixel.y + 1u < p.height) {
    uint above = i - p.width, below = i + p.width;
    float nw = float_at(intensity, above - 1u), n = float_at(intensity, above),
          ne = float_at(intensity, above + 1u);
    float w = float_at(intensity, i - 1u), e = float_at(intensity, i + 1u);
    float sw = float_at(intensity, below - 1u), s = float_at(intensity, below),
          se = float_at(intensity, below + 1u);
    g = 0.125 * vec2(ne + 2.0 * e + se - nw - 2.0 * w - sw, sw + 2.0 * s + se - nw - 2.0 * n - ne);
  }
  image[i] = GreyAndGradient(float_at(intensity, i), packHalf2x16(g));
}
