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
// Where the sums of one step of the odometry stand. A system has the upper triangle of H by rows, then b: 27.
const uint kGeometricSums = 0u;                               // a system
const uint kPhotometricSums = kGeometricSums + 27u;           // a system, of the motion alone
const uint kMomentSums = kPhotometricSums + 27u;              // of the geometric pairs, weighted: 1, s, upper triangle of s s^T
const uint kDisagreementSum = kMomentSums + 10u;              // of the same, weighted: squared sine between the normals
const uint kNearSums = kDisagreementSum + 1u;                 // of all pairs near each other: the same, and their weight
const uint kGeometricErrorSums = kNearSums + 2u;              // squared error, count
const uint kPhotometricErrorSums = kGeometricErrorSums + 2u;  // squared error, count
const uint kSurfaceCountSum = kPhotometricErrorSums + 2u;     // pixels with a surface
const uint kMixedSums = kSurfaceCountSum + 1u;                // of the photometric system, by rows: motion x (gain, offset)
const uint kBrightnessSums = kMixedSums + 12u;                // of the same: upper triangle of H of (gain, offset), then b
// What the robust scales are estimated from: weights before residuals count, and weighted squared residuals, in standard deviations of the
// sensor and in grey values.
const uint kGeometricSpreadSums = kBrightnessSums + 5u;
const uint kPhotometricSpreadSums = kGeometricSpreadSums + 2u;
const uint kGradientSums = kPhotometricSpreadSums + 2u;  // of the photometric pairs: gradient of the frame by the map's, and squared
const uint kOdometrySumCount = kGradientSums + 2u;

// Of the rotation alone.
const uint kRotationSystemSums = 0u;                        // by rows: three of H and one of b
const uint kRotationErrorSums = kRotationSystemSums + 12u;  // squared error, count
const uint kRotationSumCount = kRotationErrorSums + 2u;

// Of the agreement between a frame and the prediction.
const uint kSurfaceSum = 0u;                    // pixels with a surface
const uint kOverlapSum = kSurfaceSum + 1u;      // of these on the prediction
const uint kAgreeingSum = kOverlapSum + 1u;     // of these on its surface
const uint kInFrontSum = kAgreeingSum + 1u;     // of these in front of it
const uint kColouredSum = kInFrontSum + 1u;     // of those on its surface, with colour; all below are of these
const uint kGreySums = kColouredSum + 1u;       // grey - 128 of frame and reference
const uint kGreySquareSums = kGreySums + 2u;    // of both squared, and their product
const uint kChangeSums = kGreySquareSums + 3u;  // of grey to the next pixels, in frame and reference
const uint kAgreementSumCount = kChangeSums + 2u;

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
  uint first_group;    // where in the partial sums those of this dispatch begin, in workgroups
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
