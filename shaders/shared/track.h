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
// triangle of s s^T, squared sine between the normals. Then geometric squared error and count, photometric squared error and count,
// pixels with a surface. Then what the photometric system has of gain and offset: by rows pose x (gain, offset), the upper triangle among
// them, b. At the end what the robust scales are estimated from: of the geometric pairs the weight and the weighted squared residual in
// standard deviations of the sensor, of the photometric ones in grey values.
#define HERMITE_ODOMETRY_TERMS 91
// By rows: three of H and one of b; then squared error and count.
#define HERMITE_ROTATION_TERMS 14
// Pixels with a surface, of these on the prediction, of these on its surface, in front of it; of those on its surface: with colour, sum of
// grey - 128 of frame and reference, of their squares, of their products, of the changes of grey to the next pixels in both.
#define HERMITE_AGREEMENT_TERMS 12

struct OdometryParams {
  Transform reference_from_camera;
  Intrinsics camera, reference;  // of this level
  float geometric_weight;        // of a squared metre beside a squared grey value
  float distance_gate_m;
  float sine_normal_gate;
  float photometric_sigma;  // grey values: rows of mature pairs are weighted by 1 / sigma^2, and by how robust they are
  float gradient_min;       // grey values per pixel
  float photometric_depth_gate_m;
  uint search_radius;  // 0: projective association
};

// How residuals are believed to be distributed: in a buffer, since push constants of 128 bytes have no room for it.
struct ResidualModel {
  float noise_floor_m, noise_growth_per_m;   // standard deviation of a measurement: floor + growth (z - 0.4 m)^2
  float geometric_scale, photometric_scale;  // of the residuals' spread: standard deviations of a measurement, and grey values
  float photometric_gate;                    // pairs farther from the surface have no picture in common, in geometric scales
  float mature_confidence;                   // surfels of less confidence say less about the picture
  float gain, offset;                        // grey of the frame = gain * grey of the reference + offset
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
