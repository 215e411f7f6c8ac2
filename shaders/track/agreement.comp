#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Measures how well a frame fits the predicted surface once its pose is known: whether it sees what
// the map shows, and whether that looks the same.
#include "shaders/shared/track.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surface_point.glsl"
const uint kTerms = kAgreementSumCount;
const uint kGroupSize = HERMITE_ODOMETRY_GROUP_SIZE;
layout(local_size_x = HERMITE_ODOMETRY_GROUP_SIZE) in;
TEXELS(0, points);
TEXELS(1, intensity);
TEXELS(2, reference_points);
TEXELS(3, reference_intensity);
layout(scalar, binding = 4) writeonly buffer Sums { float partial_sums[]; };
PARAMETERS(AgreementParams, p);
#include "shaders/lib/sums.glsl"

uint at(Intrinsics camera, ivec2 pixel) { return uint(pixel.y) * camera.width + uint(pixel.x); }

// Returns the grey differences to the next pixels, of frame and reference; zero if one of them has
// no neighbours.
vec2 changes(uvec2 frame_pixel, ivec2 pixel) {
  ivec2 f = ivec2(frame_pixel), right = ivec2(1, 0), down = ivec2(0, 1);
  if (!inside(p.camera, f + 1) || !inside(p.reference, pixel + 1)) return vec2(0.0);
  float known = float_at(reference_intensity, at(p.reference, pixel));
  float known_right = float_at(reference_intensity, at(p.reference, pixel + right));
  float known_down = float_at(reference_intensity, at(p.reference, pixel + down));
  if (min(min(known, known_right), known_down) < 0.0) return vec2(0.0);
  float seen = float_at(intensity, at(p.camera, f));
  return vec2(abs(float_at(intensity, at(p.camera, f + right)) - seen) +
                  abs(float_at(intensity, at(p.camera, f + down)) - seen),
              abs(known_right - known) + abs(known_down - known));
}

void main() {
  vec2 change = vec2(0.0);                 // frame, reference
  float surface = 0.0, overlap = 0.0, agreeing = 0.0, in_front = 0.0, coloured = 0.0;
  vec2 grey = vec2(0.0);                   // frame, reference
  vec3 grey_squares = vec3(0.0);           // frame^2, reference^2, frame * reference
  for (uint i = gl_GlobalInvocationID.x; i < p.camera.width * p.camera.height;
       i += gl_NumWorkGroups.x * kGroupSize) {
    SurfacePoint point_seen = point_at(points, i);
    float z = point_seen.depth_m;
    if (z <= 0.0 || point_seen.weight <= 0.0) continue;  // masked: see frame/mask
    surface += 1.0;
    uvec2 seen_at = uvec2(i % p.camera.width, i / p.camera.width);
    vec3 point = transform_point(p.reference_from_camera, pixel_ray(p.camera, vec2(seen_at)) * z);
    ivec2 pixel = ivec2(floor(project(p.reference, point) + 0.5));
    if (point.z < 0.05 || !inside(p.reference, pixel)) continue;
    uint j = at(p.reference, pixel);
    SurfacePoint shown = point_at(reference_points, j);
    float reference_z = shown.depth_m;
    if (reference_z <= 0.0) continue;
    overlap += 1.0;
    // Three times the noise of the sensor, which grows with distance, plus a tolerance for the
    // model.
    float tolerance = p.tolerance_m + p.tolerance_growth_per_m * z * z;
    vec3 d = pixel_ray(p.reference, vec2(pixel)) * reference_z;
    in_front += reference_z - point.z > 2.0 * tolerance ? 1.0 : 0.0;
    if (abs(dot(unpack_normal(shown.normal), point - d)) > tolerance) continue;
    agreeing += 1.0;
    // Shifted to around zero, so that the sums keep their precision.
    float seen = float_at(intensity, i) - 128.0, known = float_at(reference_intensity, j) - 128.0;
    if (known < -128.0) continue;
    coloured += 1.0;
    grey += vec2(seen, known);
    change += changes(seen_at, pixel);
    grey_squares += vec3(seen * seen, known * known, seen * known);
  }
  put_at(kSurfaceSum, surface);
  put_at(kOverlapSum, overlap);
  put_at(kAgreeingSum, agreeing);
  put_at(kInFrontSum, in_front);
  put_at(kColouredSum, coloured);
  put_from(kGreySums);
  for (int i = 0; i < 2; ++i) put_term(grey[i]);
  put_from(kGreySquareSums);
  for (int i = 0; i < 3; ++i) put_term(grey_squares[i]);
  put_from(kChangeSums);
  for (int i = 0; i < 2; ++i) put_term(change[i]);
  write_group_sums(0u);
}
