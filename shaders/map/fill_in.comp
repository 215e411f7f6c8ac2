#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Where the map predicts too little of the view, as in the first frames, the frame's own surface stands in for it (reference notes 2.5).
// Frame and prediction are seen from the same pose.
#include "shaders/shared/map.h"
#include "shaders/lib/weight.glsl"
layout(local_size_x = 256) in;
layout(scalar, binding = 0) readonly buffer FrameDepth { float frame_depth_m[]; };
layout(scalar, binding = 1) readonly buffer FrameNormals { uint frame_normals[]; };
layout(scalar, binding = 2) readonly buffer FrameCurvatures { uint frame_curvatures[]; };
layout(scalar, binding = 3) readonly buffer FrameConfidence { float frame_confidence[]; };
layout(scalar, binding = 4) readonly buffer FrameIntensity { float frame_intensity[]; };
layout(scalar, binding = 5) buffer Depth { float depth_m[]; };
layout(scalar, binding = 6) buffer Normals { uint normals[]; };
layout(scalar, binding = 7) buffer Curvatures { uint curvatures[]; };
layout(scalar, binding = 8) buffer Weight { float weight[]; };
layout(scalar, binding = 9) buffer Intensity { float intensity[]; };
layout(scalar, binding = 10) readonly buffer Covered { uint covered_count; };
layout(scalar, push_constant) uniform Push { FillInParams p; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= p.pixel_count || covered_count >= p.covered_below) return;
  if (depth_m[i] > 0.0 || frame_depth_m[i] <= 0.0) return;
  depth_m[i] = frame_depth_m[i];
  normals[i] = frame_normals[i];
  curvatures[i] = frame_curvatures[i];
  weight[i] = tracking_weight(unpackHalf2x16(frame_curvatures[i]), frame_confidence[i] * p.confidence_scale, p.curvature_lambda_per_m,
                              frame_depth_m[i]);
  intensity[i] = p.with_color != 0u ? frame_intensity[i] : -1.0;
}
