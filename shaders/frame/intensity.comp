#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Computes the colours of the sampled pixels, their grey values (0 to 255) smoothed over 3x3 pixels
// of the image, and their Sobel gradient in grey values per sample; zero on the border.
#include "shaders/shared/frame.h"
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
TEXELS(0, color);
layout(scalar, binding = 1) writeonly buffer Intensity { float intensity[]; };
layout(scalar, binding = 2) writeonly buffer Image { GreyAndGradient image[]; };
layout(scalar, binding = 3) writeonly buffer SampledColor { uint sampled_color[]; };
PARAMETERS(IntensityParams, p);

float grey_of(uint c) { return grey(vec3(c & 255u, (c >> 8) & 255u, (c >> 16) & 255u)); }

// Returns (1 2 1) / 4 and (-1 0 1) / 2 along a row, of which `columns` are three neighbours.
vec2 row(uint first, uvec3 columns) {
  float left = grey_of(uint_at(color, first + columns.x)),
        middle = grey_of(uint_at(color, first + columns.y)),
        right = grey_of(uint_at(color, first + columns.z));
  return vec2(0.25 * (left + 2.0 * middle + right), 0.5 * (right - left));
}

void main() {
  uvec2 sampled = gl_GlobalInvocationID.xy, size = sampled_size(p.camera, p.sampling);
  if (sampled.x >= size.x || sampled.y >= size.y) return;
  ivec2 pixel = pixel_of_sample(p.sampling, sampled);
  uvec3 columns = uvec3(clamp(pixel.x + ivec3(-1, 0, 1), 0, int(p.camera.width) - 1));
  uvec3 rows =
      p.camera.width * uvec3(clamp(pixel.y + ivec3(-1, 0, 1), 0, int(p.camera.height) - 1));
  vec2 above = row(rows.x, columns), here = row(rows.y, columns), below = row(rows.z, columns);
  bool border = !inside(p.camera, pixel - 1) || !inside(p.camera, pixel + 1);
  vec2 slope = vec2(0.25 * (above.y + 2.0 * here.y + below.y), 0.5 * (below.x - above.x));
  uint index = sampled.y * size.x + sampled.x;
  sampled_color[index] = uint_at(color, rows.y + columns.y);
  float smoothed = 0.25 * (above.x + 2.0 * here.x + below.x);
  intensity[index] = smoothed;
  image[index] =
      GreyAndGradient(smoothed, border ? 0u : packHalf2x16(float(p.sampling.step) * slope));
}
