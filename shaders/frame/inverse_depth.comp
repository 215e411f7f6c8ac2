#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Converts sensor units to inverse depth, over the whole image with its margin; 0 where nothing was
// measured within the range.
#include "shaders/shared/frame.h"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
layout(local_size_x = 256) in;
TEXELS(0, units);  // eight pixels per texel
layout(scalar, binding = 1) writeonly buffer Inverse { vec4 inverse_depth_per_m[]; };
PARAMETERS(InverseDepthParams, p);

vec4 inverse_of(uvec4 pixels) {
  vec4 depth_m = vec4(pixels) * p.metres_per_unit;
  bvec4 measured = bvec4(uvec4(greaterThanEqual(depth_m, vec4(p.depth_min_m))) *
                         uvec4(lessThanEqual(depth_m, vec4(p.depth_max_m))));
  return mix(vec4(0.0), 1.0 / depth_m, measured);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= p.texel_count) return;
  uvec4 words = uvec4_at(units, i);
  uvec4 even = words & 0xffffu, odd = words >> 16;
  inverse_depth_per_m[2u * i] = inverse_of(uvec4(even.x, odd.x, even.y, odd.y));
  inverse_depth_per_m[2u * i + 1u] = inverse_of(uvec4(even.z, odd.z, even.w, odd.w));
}
