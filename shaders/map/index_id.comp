#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Second pass of the index map: the slot of that surfel, the lowest of several at exactly the same
// depth.
#include "shaders/lib/index_cell.glsl"
layout(scalar, binding = 3) buffer Nearest { NearestSurfel nearest[]; };

void main() {
  uint cell, bits;
  if (index_cell(listed_slot(), cell, bits) && nearest[cell].depth_bits == bits)
    atomicMin(nearest[cell].slot, listed_slot());
}
