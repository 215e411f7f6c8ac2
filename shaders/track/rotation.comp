#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Photometric terms of a pure rotation between two grey images (SO(3) pre-alignment):
// residual I_current(pi(R ray)) - I_previous(x), linearised for R <- exp(omega) R.
#include "shaders/shared/track.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
const uint kTerms = kRotationSumCount;
const uint kGroupSize = HERMITE_ODOMETRY_GROUP_SIZE;
layout(local_size_x = HERMITE_ODOMETRY_GROUP_SIZE) in;
TEXELS(0, previous);
TEXELS(1, current);
layout(scalar, binding = 2) writeonly buffer Sums { float partial_sums[]; };
PARAMETERS(RotationParams, p);
#include "shaders/lib/sums.glsl"

// Both images have the same size.
bool has_neighbours(ivec2 pixel) {
  return pixel.x >= 1 && pixel.y >= 1 && pixel.x + 2 < int(p.previous.width) &&
         pixel.y + 2 < int(p.previous.height);
}
uint at(ivec2 pixel) { return uint(pixel.y) * p.previous.width + uint(pixel.x); }
#define slope(image, i)                                        \
  (0.5 * vec2(float_at(image, (i) + 1u) - float_at(image, (i)-1u), \
              float_at(image, (i) + p.previous.width) - float_at(image, (i)-p.previous.width)))

void main() {
  mat3 h = mat3(0.0);
  vec3 b = vec3(0.0);
  vec2 error_count = vec2(0.0);
  uint pixels = p.previous.width * p.previous.height;
  for (uint i = gl_GlobalInvocationID.x; i < pixels; i += gl_NumWorkGroups.x * kGroupSize) {
    ivec2 x = ivec2(i % p.previous.width, i / p.previous.width);
    vec3 q = rotate(p.current_from_previous, pixel_ray(p.previous, vec2(x)));
    if (!has_neighbours(x) || q.z < 0.1) continue;
    vec2 uv = project(p.current, q);
    ivec2 y = ivec2(floor(uv));
    if (!has_neighbours(y)) continue;
    vec2 f = uv - vec2(y);
    uint j = at(y);
    uint below = j + p.previous.width;
    float value = mix(mix(float_at(current, j), float_at(current, j + 1u), f.x),
                      mix(float_at(current, below), float_at(current, below + 1u), f.x), f.y);
    float residual = value - float_at(previous, i);
    uint nearest = at(ivec2(floor(uv + 0.5)));
    vec2 g = 0.5 * (slope(previous, i) + slope(current, nearest));
    vec2 scaled = g * vec2(p.current.fx, p.current.fy) / q.z;
    vec3 a = vec3(scaled, -dot(scaled, q.xy) / q.z);
    vec3 row = cross(q, a);
    h += outerProduct(row, row);
    b -= residual * row;
    error_count += vec2(residual * residual, 1.0);
  }
  put_from(kRotationSystemSums);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) put_term(h[j][i]);
    put_term(b[i]);
  }
  put_from(kRotationErrorSums);
  put_term(error_count.x);
  put_term(error_count.y);
  write_group_sums(0u);
}
