// Push constants and sums of the odometry.
#ifndef HERMITE_SHARED_TRACK_H
#define HERMITE_SHARED_TRACK_H

#include "shaders/shared/types.h"

#ifdef __cplusplus
namespace hermite::shared {
#endif

// Sums of one workgroup; the host adds the groups in order, in double precision.
#define HERMITE_ODOMETRY_GROUPS 256  // at most
#define HERMITE_ODOMETRY_GROUP_SIZE 32
// Of the geometric, then of the photometric system: upper triangle of H by rows, b. Then of the geometric pairs, weighted: 1, s, upper
// triangle of s s^T, squared sine between the normals. At the end geometric squared error and count, photometric squared error and count,
// pixels with a surface.
#define HERMITE_ODOMETRY_TERMS 70
// By rows: three of H and one of b; then squared error and count.
#define HERMITE_ROTATION_TERMS 14
// Pixels with a surface, of these on the prediction, of these on its surface, in front of it; of those on its surface: with colour, sum of
// grey - 128 of frame and reference, of their squares, of their products, of the changes of grey to the next pixels in both.
#define HERMITE_AGREEMENT_TERMS 12

struct OdometryParams {
  Transform reference_from_camera;
  Intrinsics camera, reference;  // of this level
  float geometric_weight;   // of a squared metre beside a squared grey value
  float distance_gate_m;
  float sine_normal_gate;
  float photometric_sigma;  // grey values: rows are weighted by 1 / (sigma + |residual|)
  float gradient_min;       // grey values per pixel
  float photometric_depth_gate_m;
  uint search_radius;       // 0: projective association
};

struct AgreementParams {
  Transform reference_from_camera;
  Intrinsics camera, reference;
  float tolerance_m, tolerance_growth_per_m;  // a point lies on the surface within tolerance + growth z^2
};

struct RotationParams {
  Transform current_from_previous;  // rotation only
  Intrinsics previous, current;
};

#ifdef __cplusplus
}  // namespace hermite::shared
#endif
#endif
