// Shared by the passes that build an index map: the pixel of a surfel and the bits of its depth
// (positive floats have the order of their bits). The two passes must agree on both to the last
// bit, hence `precise`.
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
TEXELS(4, visible_blocks);
PARAMETERS(IndexParams, p);

uint listed_slot() {
  return block_of(listed_block(visible_blocks, gl_WorkGroupID.x)) * kBlock + gl_LocalInvocationID.x;
}

bool index_cell(uint slot, out uint cell, out uint bits) {
  cell = 0u;
  bits = 0u;
  // Slots in the list beyond those in use are free.
  vec4 surfel = vec4_at(position_confidence, slot);
  if (surfel.w <= 0.0 || surfel.w < p.min_confidence) return false;
  Transform t = transform_at(camera_from_submap, surfel_submap(attributes_at(attributes, slot)));
  precise vec3 point = transform_point(t, surfel.xyz);
  if (point.z <= 0.05 || point.z > p.depth_max_m) return false;
  precise vec2 uv = project(p.camera, point);
  ivec2 pixel = ivec2(floor(uv + 0.5));
  if (!inside(p.camera, pixel)) return false;
  cell = uint(pixel.y) * p.camera.width + uint(pixel.x);
  bits = floatBitsToUint(point.z);
  return true;
}
