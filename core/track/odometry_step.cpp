#include "core/track/odometry_step.h"

#include <algorithm>
#include <cmath>

namespace hermite::track {

namespace {

// Share of the frame's gradients that the map shows (odometry_sums.h): a black image, or a dark one
// of noise, has -0.03 to 0.09, recordings of a Kinect with its rolling shutter 0.23 to 0.75,
// rendered rooms 0.57 and more.
constexpr double kNoiseShare = 0.1, kImageShare = 0.2;

// From here on the frame is neither blurred nor misaligned: sharp frames of recordings have 0.7.
constexpr double kSharpShare = 0.7;

// Standard deviations of the sensor.
constexpr double kFirstGeometricScale = 10, kLeastGeometricScale = 0.25;
constexpr double kFirstPhotometricScale_grey = 30, kLeastPhotometricScale_grey = 2;

// Shares of a frame with a surface below which corners have full weight and above which they have
// none: dense terms are better there, since they relate the camera to the map, corners only to the
// last frame. For the same reason a corner counts less than a dense pair of the same deviation:
// with a tenth of the depth, living_room_part, bare walls and fr1 end 3.1, 5.1 and 18 mm off
// without corners; 3.1, 2.2 and 17 with this weight; 9.1, 2.0 and 18 with a weight of 1; 33, 2.4
// and 24 with 20.
constexpr double kSparse = 0.15, kDense = 0.3, kCornerWeight = 0.3;

// As depth gets sparse, the weight of a pixel of the image relative to that of a pair of depth with
// a residual as likely; usually it is 0.003 to 0.01. Many pairs average the noise of depth, few do
// not. With a tenth of the depth, living_room_part, bare walls and two office scenes end 4.8, 5.4,
// 6.8 and 29 mm off without this weight, 4.3, 4.3, 1.8 and 2.9 with it. More helps rendered scenes,
// but fr1, whose colour is late and distorted by its shutter, has 10.8, 5.8 with this, 11.9 with
// 0.3 and 22.7 with 1.
constexpr double kImageWeight = 0.1;

// Returns 0 at `none` and beyond, 1 at `all` and beyond, and grows linearly between them.
double share_between(double value, double none, double all) {
  return std::clamp((value - none) / (all - none), 0.0, 1.0);
}

// Returns 0 where dense terms suffice, growing to 1 as depth gets sparse.
double sparsity(const OdometrySums& sums) {
  return share_between(sums.surface_count / sums.pixel_count, kDense, kSparse);
}

// Returns the weight of corners relative to the dense terms, in their units.
double weight_of_corners(const OdometrySums& sums) {
  return kCornerWeight * sparsity(sums) * (sums.geometric_count > 0 ? sums.geometric_unit() : 1);
}

// Returns the factor of the image's usual weight, at least 1.
double weight_of_image(const OdometrySums& sums) {
  if (sums.photometric_unit() <= 0) return 1;
  const double as_certain = kImageWeight * sums.geometric_unit() / sums.photometric_unit();
  return 1 + sparsity(sums) * std::max(0.0, as_certain - 1);
}

// Returns the disagreement between normals that is noise. Beside a sharp image this includes pairs
// that do not pass the gate of angles; elsewhere these may disagree by blur or misalignment. With
// accepted pairs alone, a vignetted image between bare walls led the camera 11 cm astray; with all
// pairs always, recordings of fast motion are up to a quarter worse (tests/accuracy/LAB.md).
double noise_of_normals(const OdometrySums& sums, bool is_finest) {
  const double sharp = is_finest ? share_between(sums.gradient_share, kImageShare, kSharpShare) : 0;
  return sums.disagreement + sharp * (sums.near_disagreement - sums.disagreement);
}

// As evidence on its own, and if the image is not used, depth counts only beyond all of the noise
// of its normals.
NormalEquations known_of_depth(const OdometrySums& sums, double disagreement, bool discount) {
  return discount ? discount_normal_noise(sums.geometric, sums.displacement, disagreement)
                  : sums.geometric;
}

}  // namespace

ExpectedResiduals residuals_at_first(double reach) {
  return {reach * kFirstGeometricScale, kFirstPhotometricScale_grey, {}};
}

ExpectedResiduals residuals_after(const ExpectedResiduals& before, const OdometrySums& sums,
                                  const Vector6d& step) {
  ExpectedResiduals after = before;
  if (sums.geometric_spread2 > 0)
    after.geometric_scale = std::max(std::sqrt(sums.geometric_spread2), kLeastGeometricScale);
  if (sums.photometric_spread2 > 0)
    after.photometric_scale =
        std::max(std::sqrt(sums.photometric_spread2), kLeastPhotometricScale_grey);
  after.brightness = brightness_after(sums.photometric, before.brightness, step);
  return after;
}

double share_of_image(const OdometrySums& sums) {
  return share_between(sums.gradient_share, kNoiseShare, kImageShare);
}

StepSystems step_systems(const OdometrySums& sums, const frame::Brightness& brightness,
                         const Rigid3& reference_from_camera, const StepTerms& terms) {
  const NormalEquations known =
      known_of_depth(sums, sums.near_disagreement, terms.discount_normal_noise);
  const NormalEquations geometric =
      terms.prior ? known
                  : known_of_depth(sums, noise_of_normals(sums, terms.is_finest),
                                   terms.discount_normal_noise);
  NormalEquations photometric = without_brightness(sums.photometric, brightness);
  const double shared = share_of_image(sums);
  StepWitnesses witnesses{
      .depth = {known, sums.geometric_unit()},
      .image = {{shared * photometric.hessian, shared * photometric.right_hand_side},
                shared * sums.photometric_unit()},
      .image_weight = weight_of_image(sums),
      .displacement = sums.displacement};
  photometric.hessian *= witnesses.image_weight;
  photometric.right_hand_side *= witnesses.image_weight;
  if (terms.prior)
    photometric =
        motion_prior(sums.geometric_unit(), log_se3(reference_from_camera * inverse(*terms.prior)));
  if (terms.corners) {
    witnesses.corners = {feature_terms(*terms.corners, reference_from_camera), 1};
    witnesses.corner_weight = weight_of_corners(sums);
    photometric.hessian += witnesses.corner_weight * witnesses.corners.system.hessian;
    photometric.right_hand_side +=
        witnesses.corner_weight * witnesses.corners.system.right_hand_side;
  }
  return {geometric, photometric, witnesses};
}

}  // namespace hermite::track
