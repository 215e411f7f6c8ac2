#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// What association asks of the surfel in each pixel of the index map, once instead of by all of its neighbours: where in the pixel it lies
// and its normal in the camera's frame. (Its depth is in the index map.)
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/surfel.glsl"
layout(local_size_x = 256) in;
layout(scalar, binding = 0) readonly buffer Positions { vec4 position_confidence[]; };
layout(scalar, binding = 1) readonly buffer Attributes { SurfelAttributes attributes[]; };
layout(scalar, binding = 2) readonly buffer Submaps { Transform camera_from_submap[]; };
layout(scalar, binding = 3) readonly buffer Ids { uint ids[]; };
layout(scalar, binding = 4) writeonly buffer Cells { IndexCell cells[]; };
layout(scalar, push_constant) uniform Push { Intrinsics camera; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= camera.width * camera.height || ids[i] == 0xffffffffu) return;
  SurfelAttributes a = attributes[ids[i]];
  Transform t = camera_from_submap[surfel_submap(a)];
  vec2 pixel = vec2(i % camera.width, i / camera.width);
  vec2 offset = project(camera, transform_point(t, position_confidence[ids[i]].xyz)) - pixel;
  cells[i] = IndexCell(packSnorm2x16(2.0 * offset), pack_unit(rotate(t, unpack_unit(a.normal))));
}
