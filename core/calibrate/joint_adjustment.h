// Poses of views and the numbers of their camera at once, by Gauss and Newton: points of one view on planes of another, and corners of the
// picture that are seen by both. Neither is believed for what it was taken for at first: both are associated anew before each step, with
// gates that begin as wide as poses bent by a wrong camera are off and narrow to the noise.
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

// What is free of a camera, in the order of every vector and matrix here.
enum CameraNumber : std::size_t {
  kFocal,          // logarithm of a factor of fx and fy alike
  kCenterX,        // of cx [px]
  kCenterY,        // of cy [px]
  kBend,           // of DepthDistortion::bend
  kInverseOffset,  // of DepthDistortion::inverse_offset_per_m
  kCameraNumbers,
};
using CameraVector = Eigen::Matrix<double, kCameraNumbers, 1>;
using CameraMatrix = Eigen::Matrix<double, kCameraNumbers, kCameraNumbers>;

// `camera` with `change` added.
Camera changed(const Camera& camera, const CameraVector& change);

struct CalibrationView {
  Rigid3 world_from_camera;
  PatchGrid patches;
  std::vector<Feature> features;  // their depth as measured
};

struct ViewPair {
  std::uint32_t first = 0, second = 0;
};

struct JointOptions {
  std::array<bool, kCameraNumbers> is_free{true, true, true, true, true};
  CameraVector prior_deviation;  // of the change, whose prior mean is zero
  unsigned thread_count = 2;
};

struct JointSolution {
  std::vector<Rigid3> world_from_camera;  // by view
  CameraVector change = CameraVector::Zero();
  CameraMatrix covariance = CameraMatrix::Zero();  // zero rows of what is not free
};

// `views` are of `camera`, straight. Errors: none; views that no pair holds stay where they are.
JointSolution adjust_jointly(const std::vector<CalibrationView>& views, const std::vector<ViewPair>& pairs, const Camera& camera,
                             const JointOptions& options);

// How far the surfaces of pairs are apart: distances of points to planes, cut to kCut_m, both ways.
struct PairAgreement {
  double median_m = 0, rms_m = 0;
  std::int64_t point_count = 0;
};
PairAgreement agreement_of(const std::vector<CalibrationView>& views, const std::vector<Rigid3>& world_from_camera,
                           const std::vector<ViewPair>& pairs, const Camera& camera);

}  // namespace hermite
