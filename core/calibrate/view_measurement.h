// The measurements of calibration: distances of points of one view to planes of another, and
// reprojection errors of image corners seen in both, with their derivatives by the poses and by the
// camera's parameters.
//
// Points and planes both have noise. If a residual and its derivative share the same noise, the
// estimate is biased towards zero (errors in variables). Therefore the distance is taken along the
// target's normal and its derivative along the source's normal, so that no common noise is
// multiplied.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include "core/adjust/features.h"
#include "core/calibrate/camera_numbers.h"
#include "core/calibrate/corner_matches.h"
#include "core/calibrate/patches.h"
#include "core/math/rigid3.h"

namespace hermite::calibrate {

struct CalibrationView {
  Rigid3 world_from_camera;
  PatchGrid patches;
  std::vector<adjust::Feature> features;  // with depth as measured
  // Of the camera (core/math/image_timing.h); a view without it counts as one of a camera at rest.
  std::optional<Vector6d> known_twist_per_s{};

  Vector6d twist_per_s() const { return known_twist_per_s.value_or(Vector6d::Zero()); }
};

// Indices of two different views.
struct ViewPair {
  std::uint32_t first = 0, second = 0;
};

// One side of a pair: points of the source are measured in the target. Indices of views.
struct PairSide {
  std::uint32_t source = 0, target = 0;
  Rigid3 target_from_source;
};

// Parameters of one side of a pair: a twist of the point's view in its own camera frame, and the
// camera's parameters.
inline constexpr Eigen::Index kSideNumberCount = 6 + kCameraNumberCount;

// Information matrix and gradient of the cost of one view's points against another view; the cost
// is half the quadratic form.
struct SideQuadratic {
  using Vector = Eigen::Matrix<double, kSideNumberCount, 1>;
  using Matrix = Eigen::Matrix<double, kSideNumberCount, kSideNumberCount>;
  Matrix information = Matrix::Zero();  // only the lower half is set
  Vector gradient = Vector::Zero();
};

// A point of the source that lies on a surface of the target.
struct SurfaceMatch {
  Eigen::Vector3d in_source_m, in_target_m;
  Eigen::Vector2d source_px, target_px;
  Eigen::Vector3d normal_in_target;  // the source's
  double distance_m;                 // from the target's plane
  double behind_m;                   // the same along the ray of the target
  double sigma_m, gate_m;
};

// Calls work(i) for every i; thread t takes t, t + thread_count, ...
template <class Work>
void for_all(std::size_t count, unsigned thread_count, const Work& work) {
  std::vector<std::jthread> threads;
  for (unsigned t = 0; t < thread_count; ++t)
    threads.emplace_back([=, &work] {
      for (std::size_t i = t; i < count; i += thread_count) work(i);
    });
}

// All views with one trial camera. Holds a reference to the views. Const functions are thread-safe.
class ViewMeasurement {
 public:
  ViewMeasurement(const std::vector<CalibrationView>& views, const Camera& trial,
                  unsigned thread_count);

  const Camera& camera() const { return camera_; }

  // Returns the correspondences of some nodes of the source with all nodes of the target, in their
  // order.
  std::vector<SurfaceMatch> surface_matches(const PairSide& side, double gate_m) const;

  void add_surfaces(const PairSide& side, double gate_m, SideQuadratic& sum) const;

  // Returns corners of the source with corners of the target that look alike and are near.
  std::vector<adjust::LandmarkMatch> corner_matches(const PairSide& side,
                                                    const MeasurementGates& gates) const;

  // Returns the distances of the source's corners, projected into the target, from where they are
  // seen there [px].
  std::vector<Eigen::Vector2d> corner_errors_px(const PairSide& side,
                                                const MeasurementGates& gates) const;

  // Adds the reprojection error of a corner of the source in the target.
  void add_corner(const PairSide& side, const adjust::LandmarkMatch& match, double gate_px,
                  SideQuadratic& sum) const;

 private:
  struct Sighting;  // of a corner of one view in another one
  std::optional<Sighting> sighting(const PairSide& side, const adjust::LandmarkMatch& match) const;
  // Returns the corner where the mean of both measurements sees it, with its error as measured.
  Sighting halfway(Sighting corner) const;
  using PointByCamera = Eigen::Matrix<double, 3, kCameraNumberCount>;
  PointByCamera derivative_by_camera(const Eigen::Vector3d& point_m,
                                     const Eigen::Vector2d& pixel_px) const;
  double color_time_s(const Eigen::Vector2d& pixel_px) const;

  const std::vector<CalibrationView>& views_;
  const Camera camera_;
  std::vector<std::vector<Facet>> facets_;             // by view, at the view's time stamp
  std::vector<std::vector<adjust::Feature>> corners_;  // by view, in the undistorted image
};

}  // namespace hermite::calibrate
