#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Second half of the index map: which surfel that is; of several at exactly the same depth the lowest slot.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/blocks.glsl"
layout(local_size_x = 256) in;
TEXELS(0, position_confidence);
TEXELS(1, attributes);
TEXELS(2, camera_from_submap);
TEXELS(3, depth_bits);
layout(scalar, binding = 4) buffer Ids { uint ids[]; };
TEXELS(5, visible_blocks);
PARAMETERS(IndexParams, p);
#include "shaders/lib/index_cell.glsl"

void main() {
  uint cell, bits;
  if (index_cell(listed_slot(), cell, bits) && uint_at(depth_bits, cell) == bits) atomicMin(ids[cell], listed_slot());
}
