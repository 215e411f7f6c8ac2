#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Moves depth to the time stamp of its frame, given the motion of the camera to the time of each
// row; 0 where the image does not show what was there. An invocation computes the two pixels of a
// word.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
layout(local_size_x = 128) in;
TEXELS(0, units);
TEXELS(1, row_from_stamp);
layout(scalar, binding = 2) writeonly buffer AtStamp { uint units_at_stamp[]; };
PARAMETERS(RetimeParams, p);
#include "shaders/lib/retime.glsl"

// The row in which a point is seen depends on the time at which that row is taken, and its depth on
// where it is seen. Each step divides the error by about the readout over the time in which the
// image moves by its own height, 30 for a fast hand; at a grazing view by less.
const int kSteps = 5;
// As shares of the depth: an iteration has settled, and a ray whose iteration still changes by more
// lies between two surfaces.
const float kSettled = 1e-4, kUnsettled = 3e-3;
// Ratio of depths above which neighbours lie on two surfaces.
const float kOneSurface = 1.03;

// In the image, the inverse depth of a plane is linear. Returns the nearest pixel's depth between
// two surfaces.
float depth_between(vec2 at_px) {
  uvec2 corner = min(uvec2(at_px), uvec2(p.camera.width, p.camera.height) - 2u);
  vec2 share = at_px - vec2(corner);
  uint index = corner.y * p.camera.width + corner.x;
  vec4 four = vec4(units_at(index), units_at(index + 1u), units_at(index + p.camera.width),
                   units_at(index + p.camera.width + 1u));
  float least = min(min(four.x, four.y), min(four.z, four.w)),
        greatest = max(max(four.x, four.y), max(four.z, four.w));
  vec2 nearest = share.y >= 0.5 ? four.zw : four.xy;
  vec4 inverse = 1.0 / max(four, vec4(1.0));
  float smooth_units =
      1.0 / mix(mix(inverse.x, inverse.y, share.x), mix(inverse.z, inverse.w, share.x), share.y);
  bool is_edge = least == 0.0 || greatest > kOneSurface * least;
  return p.metres_per_unit * (is_edge ? (share.x >= 0.5 ? nearest.y : nearest.x) : smooth_units);
}

// Returns the depth of a pixel at the time stamp; 0: unknown.
float depth_at_stamp(vec2 pixel, float as_taken_m) {
  vec3 ray = pixel_ray(p.camera, pixel);
  vec2 last_px = vec2(p.camera.width, p.camera.height) - 1.0, at_px = pixel;
  float depth_m = as_taken_m, change_m = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    Transform motion = transform_at(row_from_stamp, row_at(at_px.y));
    vec3 direction = seen_in_row(motion, ray, depth_m);
    if (direction.z <= 0.0) return 0.0;
    vec2 wanted_px = project(p.camera, direction);
    at_px = clamp(wanted_px, vec2(0.0), last_px);
    vec2 outside_px = abs(wanted_px - at_px);
    if (max(outside_px.x, outside_px.y) > 0.5) return 0.0;
    float measured_m = depth_between(at_px);
    if (measured_m == 0.0) {
      if (depth_m == 0.0) return 0.0;
      change_m = depth_m;
      depth_m = 0.0;
      continue;
    }
    float here_m = max(0.0, transform_back(motion, measured_m / direction.z * direction).z);
    change_m = abs(here_m - depth_m);
    depth_m = here_m;
    if (change_m < kSettled * depth_m) return depth_m;
  }
  return change_m > kUnsettled * depth_m ? 0.0 : depth_m;
}

uint retimed(uint index) {
  if (index >= p.camera.width * p.camera.height) return 0u;
  float depth_m = depth_at_stamp(vec2(index % p.camera.width, index / p.camera.width),
                                 p.metres_per_unit * float(units_at(index)));
  float rounded = floor(depth_m / p.metres_per_unit + 0.5);
  return rounded <= 65535.0 ? uint(rounded) : 0u;
}

void main() {
  uint word = gl_GlobalInvocationID.x;
  if (2u * word >= p.camera.width * p.camera.height) return;
  units_at_stamp[word] = retimed(2u * word) | retimed(2u * word + 1u) << 16;
}
