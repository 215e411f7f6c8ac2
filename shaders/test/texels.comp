// For the tests of core/gpu: the words of buffers whose elements have 2, 4, 8 and 48 bytes, read as
// texels.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/types.h"
#include "shaders/lib/texels.glsl"

layout(local_size_x = 1) in;
TEXELS(0, halves);
TEXELS(1, words);
TEXELS(2, pairs);
TEXELS(3, transforms);
layout(scalar, binding = 4) writeonly buffer Target { uint target[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x, first = 16u * i;
  target[first] = uint_at(halves, i);
  target[first + 1u] = floatBitsToUint(float_at(words, i));
  const uvec2 pair = uvec2_at(pairs, i);
  target[first + 2u] = pair.x;
  target[first + 3u] = pair.y;
  const Transform t = transform_at(transforms, i);
  for (uint k = 0u; k < 4u; ++k) {
    target[first + 4u + k] = floatBitsToUint(t.row0[k]);
    target[first + 8u + k] = floatBitsToUint(t.row1[k]);
    target[first + 12u + k] = floatBitsToUint(t.row2[k]);
  }
}
