// Push constants of the passes that turn a frame into frame maps.
#ifndef HERMITE_SHARED_FRAME_H
#define HERMITE_SHARED_FRAME_H

#include "shaders/shared/types.h"

#ifdef __cplusplus
namespace hermite::shared {
#endif

// The whole depth image has a margin without depth, so that windows with a radius up to it need no
// bounds checks and rows consist of whole texels.
#define HERMITE_DEPTH_MARGIN 8
#define HERMITE_DEPTH_STRIDE(width) (((width) + 7) / 8 * 8 + 2 * HERMITE_DEPTH_MARGIN)

struct InverseDepthParams {
  uint texel_count;
  float metres_per_unit;
  float depth_min_m, depth_max_m;
};

struct BilateralParams {
  Intrinsics camera;  // of the whole image
  Sampling sampling;
  float inverse_two_sigma_space2;  // 1/px^2
  // Standard deviation of a measurement: floor + growth (z - 0.4 m)^2.
  float noise_floor_m, noise_growth_per_m;
  float noise_sigmas;  // sigma over depth, in these deviations
};

struct NormalParams {
  Intrinsics camera;
  float depth_gate_m;  // neighbours whose depths differ by more are on another surface
  float radius_scale;  // support radius in pixel diagonals of a frontal surface
};

struct SurfaceParams {
  Intrinsics camera;
  float radius_scale;  // as above
  float depth_gate_m;
  float confidence_epsilon;     // paper Eq. 5, in units of sqrt(|gradient|)
  float curvature_limit_per_m;  // larger curvatures are meaningless
  uint use_hrbf_confidence;
  uint project_to_surface;
};

struct IntensityParams {
  Intrinsics camera;  // of the whole image
  Sampling sampling;
};

struct GradientParams {
  uint width, height;
};

struct MaskParams {
  uint width, height;            // of the level
  uint mask_width, mask_height;  // of the coarsest level
  uint shift;                    // levels between them
};

struct RetimeParams {
  Intrinsics camera;  // of the whole image
  float metres_per_unit;
};

struct DownsampleParams {
  uint width, height;  // of the coarser level
  uint fine_width;
  float depth_gate_m;
};

#ifdef __cplusplus
}  // namespace hermite::shared
#endif
#endif
