#include "core/adjust/projection_match.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/adjust/bundle_noise.h"

namespace hermite::adjust {
namespace {

constexpr double kMaxTurn_rad = M_PI / 6;
constexpr double kMaxOctaveDifference = 1.5;  // one octave, plus the rounding of both
constexpr double kLeastCosine = 0.5;          // 60 degrees
constexpr double kDepthSigmas = 3;
constexpr double kLeastDepthGate_m = 0.03;

// Features in a grid of image cells, so that a landmark is only compared with its neighbours.
class FeatureGrid {
 public:
  FeatureGrid(const std::vector<Feature>& features, const Camera& camera)
      : columns_(camera.width / kSide_px + 1), rows_(camera.height / kSide_px + 1) {
    std::vector<std::uint32_t> cell_of(features.size());
    starts_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
    for (std::size_t i = 0; i < features.size(); ++i) {
      cell_of[i] = static_cast<std::uint32_t>(row(features[i].pixel_px.y()) * columns_ +
                                              column(features[i].pixel_px.x()));
      ++starts_[cell_of[i] + 1];
    }
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    indices_.resize(features.size());
    for (std::uint32_t i = 0; i < features.size(); ++i) indices_[next[cell_of[i]]++] = i;
  }

  // Calls `visit` with the index of every feature in the cells that the circle touches.
  template <class Visit>
  void visit_around(const Eigen::Vector2d& center_px, double radius_px, const Visit& visit) const {
    for (int y = row(center_px.y() - radius_px); y <= row(center_px.y() + radius_px); ++y)
      for (int x = column(center_px.x() - radius_px); x <= column(center_px.x() + radius_px); ++x) {
        const auto cell = static_cast<std::size_t>(y * columns_ + x);
        for (std::uint32_t i = starts_[cell]; i < starts_[cell + 1]; ++i) visit(indices_[i]);
      }
  }

 private:
  static constexpr int kSide_px = 16;  // about the radius in the middle octaves
  static int square(double coordinate_px, int count) {
    // NaN gives 0.
    return coordinate_px > 0 ? static_cast<int>(std::min(coordinate_px / kSide_px,
                                                         static_cast<double>(count - 1)))
                             : 0;
  }
  int column(double x_px) const { return square(x_px, columns_); }
  int row(double y_px) const { return square(y_px, rows_); }

  int columns_, rows_;
  std::vector<std::uint32_t> starts_, indices_;  // starts_: where the indices of each cell begin
};

// The expected appearance of a landmark from the camera.
struct Expectation {
  Eigen::Vector2d pixel_px;
  double depth_m, depth_sigma_m;
  double octave;
  double angle_rad;
};

double wrapped_rad(double angle_rad) { return std::remainder(angle_rad, 2 * M_PI); }

// Returns the image orientation `angle_rad` at a point as another camera sees it: the direction,
// perpendicular to the line of sight, is rotated into that camera.
double angle_seen_rad(double angle_rad, const Eigen::Matrix3d& to_from_camera,
                      const Eigen::Vector3d& point_in_to) {
  const Eigen::Vector3d direction =
      to_from_camera * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0);
  const double along_x = direction.x() * point_in_to.z() - direction.z() * point_in_to.x();
  const double along_y = direction.y() * point_in_to.z() - direction.z() * point_in_to.y();
  return std::atan2(along_y, along_x);
}

// Returns false if the landmark cannot be seen from there.
bool expect(const SparseMap& map, const Landmark& landmark, const Rigid3& camera_from_world,
            Expectation& expectation) {
  const Eigen::Vector3d in_world = position_in_world_m(map, landmark),
                        in_camera = camera_from_world * in_world;
  if (!(in_camera.z() > 0) || !in_camera.allFinite()) return false;
  expectation.pixel_px = map.camera.project(in_camera);
  if (!(expectation.pixel_px.array() >= 0).all() ||
      !(expectation.pixel_px.x() <= map.camera.width - 1) ||
      !(expectation.pixel_px.y() <= map.camera.height - 1))
    return false;

  const Observation& last = landmark.observations.back();
  const Keyframe& keyframe = map.keyframes[last.keyframe];
  const Feature& seen = keyframe.features[last.feature];
  const Rigid3 camera_from_last = camera_from_world * world_from_camera(map, keyframe);
  const Eigen::Vector3d from_last = in_camera - camera_from_last.translation;
  if (from_last.dot(in_camera) < kLeastCosine * from_last.norm() * in_camera.norm()) return false;

  const double depth_from_last_m = (camera_from_last.rotation.conjugate() * from_last).z();
  if (!(depth_from_last_m > 0)) return false;
  expectation.depth_m = in_camera.z();
  expectation.depth_sigma_m = position_sigma_m(map, landmark);
  expectation.octave =
      seen.octave + std::log(depth_from_last_m / in_camera.z()) / std::log(kOctaveScale);
  expectation.angle_rad =
      angle_seen_rad(seen.angle_rad, camera_from_last.rotation.toRotationMatrix(), in_camera);
  return true;
}

bool fits(const Feature& feature, const Expectation& expected, double radius_px) {
  if (std::abs(feature.octave - expected.octave) > kMaxOctaveDifference) return false;
  const double allowed_px = radius_px * octave_scale(feature.octave);
  if (!((feature.pixel_px.cast<double>() - expected.pixel_px).squaredNorm() <=
        allowed_px * allowed_px))
    return false;
  if (!(std::abs(wrapped_rad(feature.angle_rad - expected.angle_rad)) <= kMaxTurn_rad))
    return false;
  if (feature.depth_m <= 0) return true;
  const double gate_m = std::max(
      kLeastDepthGate_m,
      kDepthSigmas * std::hypot(depth_deviation_m(feature.depth_m), expected.depth_sigma_m));
  return std::abs(feature.depth_m - expected.depth_m) <= gate_m;
}

// Returns the feature with the nearest descriptor around the landmark; feature_count if none is
// near and distinctive enough.
LandmarkMatch nearest(const Landmark& landmark, const Expectation& expected,
                      const std::vector<Feature>& features, const FeatureGrid& grid,
                      const ProjectionOptions& options) {
  const auto none = static_cast<std::uint32_t>(features.size());
  LandmarkMatch best{none, 0, options.max_distance + 1};
  std::vector<LandmarkMatch> around;
  const double largest_scale = octave_scale(
      std::min(kOctaveCount - 1, static_cast<int>(expected.octave + kMaxOctaveDifference) + 1));
  grid.visit_around(expected.pixel_px, options.radius_px * largest_scale, [&](std::uint32_t i) {
    if (!fits(features[i], expected, options.radius_px)) return;
    around.push_back({i, 0, hamming(landmark.descriptor, features[i].descriptor)});
    if (std::tie(around.back().distance, i) < std::tie(best.distance, best.feature))
      best = around.back();
  });
  for (const LandmarkMatch& other : around)
    if (other.feature != best.feature && best.feature != none &&
        features[other.feature].octave == features[best.feature].octave &&
        best.distance >= options.max_ratio * other.distance)
      return {none, 0, 0};
  return best;
}

}  // namespace

std::vector<LandmarkMatch> match_projected(const SparseMap& map,
                                           const std::vector<std::uint32_t>& landmarks,
                                           const std::vector<Feature>& features,
                                           const Rigid3& world_from_camera,
                                           const ProjectionOptions& options) {
  if (!is_finite(world_from_camera)) return {};
  const FeatureGrid grid(features, map.camera);
  const Rigid3 camera_from_world = inverse(world_from_camera);
  std::vector<LandmarkMatch> matches;
  for (const std::uint32_t landmark : landmarks) {
    Expectation expected;
    if (map.landmarks[landmark].observations.empty() ||
        !expect(map, map.landmarks[landmark], camera_from_world, expected))
      continue;
    LandmarkMatch match = nearest(map.landmarks[landmark], expected, features, grid, options);
    if (match.feature == features.size()) continue;
    match.landmark = landmark;
    matches.push_back(match);
  }
  return one_to_one(std::move(matches));
}

std::vector<LandmarkMatch> one_to_one(std::vector<LandmarkMatch> matches) {
  std::sort(matches.begin(), matches.end(), [](const LandmarkMatch& a, const LandmarkMatch& b) {
    return std::tie(a.distance, a.feature, a.landmark) <
           std::tie(b.distance, b.feature, b.landmark);
  });
  std::uint32_t feature_count = 0, landmark_count = 0;
  for (const LandmarkMatch& match : matches) {
    feature_count = std::max(feature_count, match.feature + 1);
    landmark_count = std::max(landmark_count, match.landmark + 1);
  }
  std::vector<bool> feature_taken(feature_count), landmark_taken(landmark_count);
  std::erase_if(matches, [&](const LandmarkMatch& match) {
    if (feature_taken[match.feature] || landmark_taken[match.landmark]) return true;
    feature_taken[match.feature] = landmark_taken[match.landmark] = true;
    return false;
  });
  std::sort(matches.begin(), matches.end(),
            [](const LandmarkMatch& a, const LandmarkMatch& b) { return a.feature < b.feature; });
  return matches;
}

}  // namespace hermite::adjust
