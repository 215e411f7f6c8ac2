// Poses of views and the numbers of their camera at once, by Gauss and Newton: points of one view on planes of another, and corners of the
// picture that both see. What was associated with what at first is not believed: it is done anew before each step, with gates that begin as
// wide as poses bent by a wrong camera are off, and narrow.
//
// Points and planes both have noise. Where a residual and its derivative have the same, a fit shrinks towards doing nothing (errors in
// variables): a distance is taken along the target's normal, its derivative along the source's, so that at the end what has noise in common
// is not multiplied.
//
// Deterministic whatever the number of threads: pairs are measured one by one and added in their order.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/adjust/features.h"
#include "core/calibrate/patches.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite {

// What may change of a camera, in the order of every vector and matrix here.
enum CameraNumber : std::size_t {
  kFocal,          // logarithm of a factor of fx and fy alike
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
  std::vector<Feature> features;  // their depth as measured
};

// Indices of views, not the same.
struct ViewPair {
  std::uint32_t first = 0, second = 0;
};

struct JointOptions {
  std::array<bool, kCameraNumberCount> is_free{};
  CameraVector prior_deviation = CameraVector::Ones();  // of the change, whose mean is 0 beforehand
  unsigned thread_count = 1;                            // at least 1; changes nothing but the time
};

struct JointSolution {
  std::vector<Rigid3> world_from_camera;  // by view; the first and those in no pair stay where they are
  CameraVector change = CameraVector::Zero();
  // Of the change. Residuals of one pair are off together, and pairs that share a view are too: what counts as independent is how the
  // gradients of whole pairs scatter, those with a view in common taken together (the dyadic sandwich of Aronow, Samii, Assenova 2015).
  CameraVector deviation = CameraVector::Zero();
};

// `camera` is that of straight frames, with the correction of depth from which the change begins. `start` is a solution of the same with
// other numbers free, from where the widest gates are not needed any more. Some 0.1 s of processor a step for 40 views and 300 pairs; 5 to
// 15 steps. CHECK: an index of a pair beyond the views.
JointSolution adjust_jointly(const std::vector<CalibrationView>& views, const std::vector<ViewPair>& pairs, const Camera& camera,
                             const JointOptions& options, const JointSolution* start = nullptr);

// How far the surfaces of pairs are apart: the distances of points to the planes of the other view, both ways. Up to kMostApart_m they are
// of one surface, and are cut to kMostCounted_m, as in depth_consistency.h.
inline constexpr double kMostApart_m = 0.10, kMostCounted_m = 0.05;
struct PairAgreement {
  double median_m = 0, rms_m = 0;
  double mean_depth_m = 0;  // a camera that makes everything smaller makes distances smaller too, and is no better for it
  std::int64_t point_count = 0;
};
PairAgreement agreement_of(const std::vector<CalibrationView>& views, const std::vector<Rigid3>& world_from_camera,
                           const std::vector<ViewPair>& pairs, const Camera& camera);

// The same of each pair alone.
std::vector<PairAgreement> agreements_of(const std::vector<CalibrationView>& views, const std::vector<Rigid3>& world_from_camera,
                                         const std::vector<ViewPair>& pairs, const Camera& camera);

}  // namespace hermite
