#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Where the map covers too little of the view, as in the first frames, the frame's own surface
// completes the prediction. Frame and prediction have the same pose.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surface_point.glsl"
#include "shaders/lib/weight.glsl"
layout(local_size_x = 256) in;
TEXELS(0, frame_points);
TEXELS(1, frame_intensity);
layout(scalar, binding = 2) buffer Points { SurfacePoint points[]; };
layout(scalar, binding = 3) writeonly buffer Intensity { float intensity[]; };
layout(scalar, binding = 4) readonly buffer Covered { uint covered_count; };
PARAMETERS(FillInParams, p);

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= p.pixel_count || covered_count >= p.covered_below) return;
  SurfacePoint point = point_at(frame_points, i);
  // The pixel is known already, unknown to the frame, or masked.
  if (points[i].depth_m > 0.0 || point.depth_m <= 0.0 || point.weight <= 0.0) return;
  point.weight =
      tracking_weight(unpackHalf2x16(point.curvatures), point.weight * p.confidence_scale,
                      p.curvature_lambda_per_m, point.depth_m);
  points[i] = point;
  intensity[i] = p.with_color != 0u
                     ? clamp((float_at(frame_intensity, i) - p.offset) / p.gain, 0.0, 255.0)
                     : -1.0;
}
