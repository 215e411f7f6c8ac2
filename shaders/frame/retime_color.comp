#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Moves colour to the time stamp of its frame, given the depth at the time stamp and the motion of
// the camera to the time of each row of colour. Colour repeats the border of the image.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
TEXELS(0, units);
TEXELS(1, color);
TEXELS(2, row_from_stamp);
layout(scalar, binding = 3) writeonly buffer AtStamp { uint color_at_stamp[]; };
PARAMETERS(RetimeParams, p);
#include "shaders/lib/retime.glsl"

// Colour changes less than depth along an error of the row (retime_depth.comp).
const int kSteps = 2;

vec3 color_of(uint index) {
  uint packed = uint_at(color, index);
  return vec3(packed & 255u, (packed >> 8) & 255u, (packed >> 16) & 255u);
}

void main() {
  uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= p.camera.width || pixel.y >= p.camera.height) return;
  uint index = pixel.y * p.camera.width + pixel.x;
  vec3 ray = pixel_ray(p.camera, vec2(pixel));
  float depth_m = p.metres_per_unit * float(units_at(index));
  vec2 at_px = vec2(pixel), last_px = vec2(p.camera.width, p.camera.height) - 1.0;
  for (int i = 0; i < kSteps; ++i) {
    vec3 direction = seen_in_row(transform_at(row_from_stamp, row_at(at_px.y)), ray, depth_m);
    if (direction.z > 0.0) at_px = clamp(project(p.camera, direction), vec2(0.0), last_px);
  }
  uvec2 corner = min(uvec2(at_px), uvec2(last_px) - 1u);
  vec2 share = at_px - vec2(corner);
  uint first = corner.y * p.camera.width + corner.x, below = first + p.camera.width;
  vec3 mixed = mix(mix(color_of(first), color_of(first + 1u), share.x),
                   mix(color_of(below), color_of(below + 1u), share.x), share.y);
  uvec3 rounded = uvec3(mixed + 0.5);
  color_at_stamp[index] = rounded.x | rounded.y << 8 | rounded.z << 16;
}
