#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Grey values of the frame, 0 to 255.
#include "shaders/shared/frame.h"
#include "shaders/shared/map.h"
#include "shaders/lib/surfel.glsl"
layout(local_size_x = 256) in;
layout(scalar, binding = 0) readonly buffer Color { uint color[]; };
layout(scalar, binding = 1) writeonly buffer Intensity { float intensity[]; };
layout(scalar, push_constant) uniform Push { IntensityParams p; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= p.camera.width * p.camera.height) return;
  uint c = color[i];
  intensity[i] = grey(vec3(c & 255u, (c >> 8) & 255u, (c >> 16) & 255u));
}
