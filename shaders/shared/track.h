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
// Positions of the sums of one step of the odometry. A system has the upper triangle of H by rows,
// then b: 27.
const uint kGeometricSums = 0u;                      // a system
const uint kPhotometricSums = kGeometricSums + 27u;  // a system, of the motion alone
// Sums of the geometric pairs, weighted: 1, s, upper triangle of s s^T.
const uint kMomentSums = kPhotometricSums + 27u;
// Sum of the same, weighted: squared sine between the normals.
const uint kDisagreementSum = kMomentSums + 10u;
// Sums of all pairs near each other: the same, and their weight.
const uint kNearSums = kDisagreementSum + 1u;
const uint kGeometricErrorSums = kNearSums + 2u;              // squared error, count
const uint kPhotometricErrorSums = kGeometricErrorSums + 2u;  // squared error, count
const uint kSurfaceCountSum = kPhotometricErrorSums + 2u;     // pixels with a surface
// Sums of the photometric system, by rows: motion x (gain, offset).
const uint kMixedSums = kSurfaceCountSum + 1u;
// Sums of the same: upper triangle of H of (gain, offset), then b.
const uint kBrightnessSums = kMixedSums + 12u;
// Data from which the robust scales are estimated: weights before robust weighting, and weighted
// squared residuals, in standard deviations of the sensor and in grey values.
const uint kGeometricSpreadSums = kBrightnessSums + 5u;
const uint kPhotometricSpreadSums = kGeometricSpreadSums + 2u;
// Sums of the photometric pairs: gradient of the frame times the map's, and times itself.
const uint kGradientSums = kPhotometricSpreadSums + 2u;
const uint kOdometrySumCount = kGradientSums + 2u;

// Sums for the rotation alone.
const uint kRotationSystemSums = 0u;                        // by rows: three of H and one of b
const uint kRotationErrorSums = kRotationSystemSums + 12u;  // squared error, count
const uint kRotationSumCount = kRotationErrorSums + 2u;

// Sums for the agreement between a frame and the prediction.
const uint kSurfaceSum = 0u;                 // pixels with a surface
const uint kOverlapSum = kSurfaceSum + 1u;   // those of these on the prediction
const uint kAgreeingSum = kOverlapSum + 1u;  // those of these on its surface
const uint kInFrontSum = kAgreeingSum + 1u;  // those of the overlap in front of it
// Those on its surface with colour, to which all sums below refer.
const uint kColouredSum = kInFrontSum + 1u;
const uint kGreySums = kColouredSum + 1u;     // grey - 128 of frame and reference
const uint kGreySquareSums = kGreySums + 2u;  // of both squared, and their product
// Grey differences to the next pixels, in frame and reference.
const uint kChangeSums = kGreySquareSums + 3u;
const uint kAgreementSumCount = kChangeSums + 2u;

struct OdometryParams {
  Transform reference_from_camera;
  Intrinsics camera, reference;  // of this level
  float geometric_weight;        // weight of a squared metre relative to a squared grey value
  float distance_gate_m;
  float sine_normal_gate;
  // Grey values: rows of mature pairs are weighted by 1 / sigma^2 and by their robust weight.
  float photometric_sigma;
  float gradient_min;  // grey values per pixel
  float photometric_depth_gate_m;
  uint first_group;  // first workgroup of this dispatch in the partial sums
};

// The assumed distribution of residuals. It is in a buffer because it does not fit into 128 bytes
// of push constants.
struct ResidualModel {
  // Standard deviation of a measurement: floor + growth (z - 0.4 m)^2.
  float noise_floor_m, noise_growth_per_m;
  // Spread of the residuals, in standard deviations of a measurement, and in grey values.
  float geometric_scale, photometric_scale;
  // Pairs farther from the surface have no photometric term, in geometric scales.
  float photometric_gate;
  // Surfels of less confidence have less photometric weight.
  float mature_confidence;
  // Grey of the frame = gain * grey of the reference + offset.
  float gain, offset;
};

struct AgreementParams {
  Transform reference_from_camera;
  Intrinsics camera, reference;
  // A point lies on the surface within tolerance + growth z^2.
  float tolerance_m, tolerance_growth_per_m;
};

struct RotationParams {
  Transform current_from_previous;  // rotation only
  Intrinsics previous, current;
};

#ifdef __cplusplus
}  // namespace hermite::shared
#endif
#endif
