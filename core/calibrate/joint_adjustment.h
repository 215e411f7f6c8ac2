// Joint adjustment of view poses and camera parameters by Gauss-Newton, with distances of points of
// one view to planes of another, and with image corners seen in both. Correspondences are renewed
// with decreasing gates; the first gates are as wide as the errors of poses that a wrong camera has
// bent.
//
// Points and planes both have noise. If a residual and its derivative share the same noise, the
// estimate is biased towards zero (errors in variables). Therefore the distance is taken along the
// target's normal and its derivative along the source's normal, so that no common noise is
// multiplied.
//
// Deterministic for any number of threads: pairs are evaluated separately and added in their order.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/adjust/features.h"
#include "core/calibrate/patches.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite {

// The camera parameters that may change, in the order of all vectors and matrices here.
enum CameraNumber : std::size_t {
  kFocal,          // logarithm of a common factor of fx and fy
  kCenterX,        // added to cx [px]
  kCenterY,        // added to cy [px]
  kBend,           // added to DepthCorrection::bend
  kInverseOffset,  // added to DepthCorrection::inverse_offset_per_m
  kCameraNumberCount,
};
using CameraVector = Eigen::Matrix<double, kCameraNumberCount, 1>;
using CameraMatrix = Eigen::Matrix<double, kCameraNumberCount, kCameraNumberCount>;

Camera changed(const Camera& camera, const CameraVector& change);

struct CalibrationView {
  Rigid3 world_from_camera;
  PatchGrid patches;
  std::vector<Feature> features;  // with depth as measured
};

// Indices of two different views.
struct ViewPair {
  std::uint32_t first = 0, second = 0;
};

struct JointOptions {
  std::array<bool, kCameraNumberCount> is_free{};
  CameraVector prior_deviation = CameraVector::Ones();  // of the change, whose prior mean is 0
  unsigned thread_count = 1;                            // at least 1; does not affect the result
};

struct JointSolution {
  std::vector<Rigid3> world_from_camera;  // by view; the first view and views without pairs do not move
  CameraVector change = CameraVector::Zero();
  // Standard deviation of the change. Residuals within a pair are correlated, as are pairs with a
  // common view. It is therefore estimated from the scatter of whole pairs' gradients, with pairs
  // that share a view taken together (the dyadic sandwich estimator of Aronow, Samii, Assenova
  // 2015).
  CameraVector deviation = CameraVector::Zero();
};

// Adjusts poses and the free parameters. `camera` is that of the rectified frames, with the depth
// correction from which the change starts. `start` is a solution of the same problem with other
// free parameters, from which the widest gates are not needed. Takes about 0.1 s of CPU time per
// step for 40 views and 300 pairs, and 5 to 15 steps. A CHECK fails if an index of a pair is out of
// range.
JointSolution adjust_jointly(const std::vector<CalibrationView>& views, const std::vector<ViewPair>& pairs, const Camera& camera,
                             const JointOptions& options, const JointSolution* start = nullptr);

// The distances of points to the planes of the other view, both ways. Up to kMostApart_m they count
// as the same surface, and they are clipped to kMostCounted_m, as in depth_consistency.h.
inline constexpr double kMostApart_m = 0.10, kMostCounted_m = 0.05;
struct PairAgreement {
  double median_m = 0, rms_m = 0;
  double mean_depth_m = 0;  // for normalisation: a camera that shrinks everything also shrinks distances
  std::int64_t point_count = 0;
};
PairAgreement agreement_of(const std::vector<CalibrationView>& views, const std::vector<Rigid3>& world_from_camera,
                           const std::vector<ViewPair>& pairs, const Camera& camera);

// The same for each pair separately.
std::vector<PairAgreement> agreements_of(const std::vector<CalibrationView>& views, const std::vector<Rigid3>& world_from_camera,
                                         const std::vector<ViewPair>& pairs, const Camera& camera);

}  // namespace hermite
