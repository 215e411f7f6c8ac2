#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Computes, once per pixel of the index map, the surfel data that association reads from all
// neighbouring pixels: the position within the pixel and the normal in the camera frame.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
layout(local_size_x = 256) in;
TEXELS(0, position_confidence);
TEXELS(1, attributes);
TEXELS(2, camera_from_submap);
TEXELS(3, nearest);  // NearestSurfel
layout(scalar, binding = 4) writeonly buffer Cells { IndexCell cells[]; };
PARAMETERS(Intrinsics, camera);

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= camera.width * camera.height) return;
  uvec2 shown = uvec2_at(nearest, i);
  uint slot = shown.x;
  // One write: software devices write word by word.
  if (slot == HERMITE_NONE) slot = 0u;
  SurfelAttributes a = attributes_at(attributes, slot);
  Transform t = transform_at(camera_from_submap, surfel_submap(a));
  vec2 pixel = vec2(i % camera.width, i / camera.width);
  vec2 offset = project(camera, transform_point(t, vec4_at(position_confidence, slot).xyz)) - pixel;
  bool is_shown = shown.x != HERMITE_NONE;
  cells[i] = IndexCell(shown.x, shown.y, is_shown ? packSnorm2x16(2.0 * offset) : 0u,
                       is_shown ? pack_unit(rotate(t, unpack_unit(a.normal))) : 0u);
}
