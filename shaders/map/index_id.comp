#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Second half of the index map: which surfel that is; of several at exactly the same depth the lowest slot.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/blocks.glsl"
layout(local_size_x = 256) in;
layout(scalar, binding = 0) readonly buffer Positions { vec4 position_confidence[]; };
layout(scalar, binding = 1) readonly buffer Attributes { SurfelAttributes attributes[]; };
layout(scalar, binding = 2) readonly buffer Submaps { Transform camera_from_submap[]; };
layout(scalar, binding = 3) buffer Depths { uint depth_bits[]; };
layout(scalar, binding = 4) buffer Ids { uint ids[]; };
layout(scalar, binding = 5) readonly buffer Visible { uint groups[3]; uint turn_groups[3]; uint blocks[]; };
layout(scalar, push_constant) uniform Push { IndexParams p; };
#include "shaders/lib/index_cell.glsl"

void main() {
  uint cell, bits;
  if (index_cell(listed_slot(), cell, bits) && depth_bits[cell] == bits) atomicMin(ids[cell], listed_slot());
}
