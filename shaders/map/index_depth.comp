#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// First pass of the index map: the depth of the nearest surfel in every pixel, by integer minimum,
// so that the order does not matter.
#include "shaders/lib/index_cell.glsl"
layout(scalar, binding = 3) buffer Nearest { NearestSurfel nearest[]; };

void main() {
  uint cell, bits;
  if (index_cell(listed_slot(), cell, bits)) atomicMin(nearest[cell].depth_bits, bits);
}
