#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// First half of the index map: the depth of the nearest surfel in every pixel, by integer minimum (order cannot change it).
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
layout(scalar, binding = 3) buffer Depths { uint depth_bits[]; };
layout(scalar, binding = 4) buffer Ids { uint ids[]; };
TEXELS(5, visible_blocks);
PARAMETERS(IndexParams, p);
#include "shaders/lib/index_cell.glsl"

void main() {
  uint cell, bits;
  if (index_cell(listed_slot(), cell, bits)) atomicMin(depth_bits[cell], bits);
}
