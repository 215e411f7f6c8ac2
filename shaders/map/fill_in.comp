#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Where the map predicts too little of the view, as in the first frames, the frame's own surface stands in for it (reference notes 2.5).
// Frame and prediction are seen from the same pose.
#include "shaders/shared/map.h"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/weight.glsl"
layout(local_size_x = 256) in;
TEXELS(0, frame_depth_m);
TEXELS(1, frame_normals);
TEXELS(2, frame_curvatures);
TEXELS(3, frame_confidence);
TEXELS(4, frame_intensity);
layout(scalar, binding = 5) buffer Depth { float depth_m[]; };
layout(scalar, binding = 6) buffer Normals { uint normals[]; };
layout(scalar, binding = 7) buffer Curvatures { uint curvatures[]; };
layout(scalar, binding = 8) buffer Weight { float weight[]; };
layout(scalar, binding = 9) buffer Intensity { float intensity[]; };
layout(scalar, binding = 10) readonly buffer Covered { uint covered_count; };
PARAMETERS(FillInParams, p);

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= p.pixel_count || covered_count >= p.covered_below) return;
  if (depth_m[i] > 0.0 || float_at(frame_depth_m, i) <= 0.0) return;
  depth_m[i] = float_at(frame_depth_m, i);
  normals[i] = uint_at(frame_normals, i);
  curvatures[i] = uint_at(frame_curvatures, i);
  weight[i] = tracking_weight(unpackHalf2x16(uint_at(frame_curvatures, i)), float_at(frame_confidence, i) * p.confidence_scale,
                              p.curvature_lambda_per_m, float_at(frame_depth_m, i));
  intensity[i] = p.with_color != 0u ? float_at(frame_intensity, i) : -1.0;
}
