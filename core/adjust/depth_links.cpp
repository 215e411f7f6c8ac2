#include "core/adjust/depth_links.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/adjust/bundle_noise.h"

namespace hermite::adjust {

namespace {

// A point matches a surface that lies within kNear_m along the normal and twice that along the ray,
// and whose normal agrees with its own.
constexpr double kNear_m = 0.04, kAlikeCosine = 0.8;

// Keyframes farther apart, or rotated by more, share little.
constexpr double kMaxApart_m = 2.5, kFacingCosine = 0.3;
constexpr std::size_t kMostOthers = 40;

// Two keyframes overlap if enough points lie on a surface of the other: in number, as a share of
// all points, and as a share of those that have a surface of the other in front of or behind them.
constexpr int kLeastPoints = 300;
constexpr double kLeastShare = 0.15, kLeastAgreement = 0.5;

// Directions with less information than this share of the best have none: the rest is rounding.
constexpr double kNoInformation = 1e-6;

// The 95 % quantile of chi-square, one degree of freedom.
constexpr double kDistanceChi2 = 3.841;

// Information matrix and gradient of a cost by a twist; the cost is half the quadratic form.
struct Quadratic {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

Eigen::Vector3d vector_of(const DepthPlane& plane) { return {plane[0], plane[1], plane[2]}; }

// Standard deviation [m] of a point on a plane: the mean of a cell's pixels, plus the error of
// tracking.
double deviation_m(double depth_m) { return kTracked_m + depth_deviation_m(depth_m) / 2; }

// Adds the point-to-plane cost of one keyframe's points against another's planes, by a twist in the
// target's camera frame that moves the points. Returns false if they do not overlap. The distance
// is to the target's plane, but its derivative uses the source's normal. With the target's normal
// in both, their noise would correlate and pull sideways: a cell's normal is off by about 7
// degrees, and points lie beside the cell's centre.
bool measure(const std::vector<DepthPlane>& source, const std::vector<DepthPlane>& target,
             const Rigid3& target_from_source, const Camera& camera, Quadratic& sum) {
  const DepthGrid grid = depth_grid_of(camera);
  const Eigen::Matrix3d rotation = target_from_source.rotation.toRotationMatrix();
  int all = 0, opposite = 0, on_surface = 0;
  auto source_plane = source.begin();
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column, ++source_plane) {
      const Eigen::Vector3d own = vector_of(*source_plane),
                            ray = camera.unproject(grid.center_px(column), grid.center_px(row), 1);
      const double inverse_depth_per_m = own.dot(ray);
      if (!(inverse_depth_per_m >= 1 / kMaxFeatureDepth_m &&
            inverse_depth_per_m <= 1 / kMinFeatureDepth_m))
        continue;
      ++all;
      const Eigen::Vector3d point =
          rotation * (ray / inverse_depth_per_m) + target_from_source.translation;
      if (!(point.z() >= kMinFeatureDepth_m && point.z() <= kMaxFeatureDepth_m)) continue;
      const Eigen::Vector2d cell =
          (camera.project(point).array() - grid.center_px(0)) / grid.cell_px + 0.5;
      if (!(cell.x() >= 0 && cell.y() >= 0 && cell.x() < grid.columns && cell.y() < grid.rows))
        continue;
      const Eigen::Vector3d other =
          vector_of(target[grid.index(static_cast<int>(cell.x()), static_cast<int>(cell.y()))]);
      const double over_plane = other.dot(point);  // ratio of the point's depth to the plane's
      if (!(over_plane > 0)) continue;
      ++opposite;
      const Eigen::Vector3d normal = (rotation * own).normalized();
      const double distance_m = (over_plane - 1) / other.norm(),
                   behind_m = point.z() * (1 - 1 / over_plane);
      if (std::abs(distance_m) > kNear_m || std::abs(behind_m) > 2 * kNear_m ||
          normal.dot(other) < kAlikeCosine * other.norm())
        continue;
      ++on_surface;
      const double sigma_m = deviation_m(std::max(1 / inverse_depth_per_m, point.z()));
      // Cauchy's loss.
      const double weight = 1 / (sigma_m * sigma_m + distance_m * distance_m / kDistanceChi2);
      Vector6d derivative;
      derivative << normal, point.cross(normal);
      sum.information.noalias() += weight * derivative * derivative.transpose();
      sum.gradient += weight * distance_m * derivative;
    }
  }
  return on_surface >= kLeastPoints && on_surface >= kLeastShare * all &&
         on_surface >= kLeastAgreement * opposite;
}

// Returns keyframes of other submaps in the problem that may see what this one sees; if there are
// too many, an even selection over time.
std::vector<std::uint32_t> others_of(const SparseMap& map,
                                     const std::vector<Rigid3>& world_from_camera,
                                     std::uint32_t keyframe,
                                     const std::vector<std::int64_t>& place_of_submap) {
  std::vector<std::uint32_t> others;
  for (std::uint32_t other = 0; other < map.keyframes.size(); ++other) {
    const std::uint32_t submap = map.keyframes[other].submap;
    if (submap == map.keyframes[keyframe].submap || place_of_submap[submap] < 0 ||
        map.keyframes[other].planes.empty())
      continue;
    const Rigid3 &a = world_from_camera[keyframe], &b = world_from_camera[other];
    const double cosine =
        (a.rotation * Eigen::Vector3d::UnitZ()).dot(b.rotation * Eigen::Vector3d::UnitZ());
    if ((a.translation - b.translation).norm() < kMaxApart_m && cosine > kFacingCosine)
      others.push_back(other);
  }
  if (others.size() <= kMostOthers) return others;
  std::vector<std::uint32_t> spread;
  for (std::size_t i = 0; i < kMostOthers; ++i)
    spread.push_back(others[i * others.size() / kMostOthers]);
  return spread;
}

// Accumulates the costs of keyframes by pair of submaps `from` < `to`, as a function of a twist of
// `to`.
std::map<std::pair<std::uint32_t, std::uint32_t>, Quadratic> measure_submaps(
    const SparseMap& map, const std::vector<std::int64_t>& place_of_submap) {
  std::vector<Rigid3> world_from_camera;
  for (const Keyframe& keyframe : map.keyframes)
    world_from_camera.push_back(adjust::world_from_camera(map, keyframe));
  std::map<std::pair<std::uint32_t, std::uint32_t>, Quadratic> sums;
  for (std::uint32_t target = 0; target < map.keyframes.size(); ++target) {
    const std::uint32_t target_submap = map.keyframes[target].submap;
    if (place_of_submap[target_submap] < 0 || map.keyframes[target].planes.empty()) continue;
    const Rigid3 target_from_world = inverse(world_from_camera[target]);
    for (const std::uint32_t source : others_of(map, world_from_camera, target, place_of_submap)) {
      Quadratic measured;
      if (!measure(map.keyframes[source].planes, map.keyframes[target].planes,
                   target_from_world * world_from_camera[source], map.camera, measured))
        continue;
      const std::uint32_t source_submap = map.keyframes[source].submap;
      const std::uint32_t from = std::min(source_submap, target_submap),
                          to = std::max(source_submap, target_submap);
      const Matrix6d twist_of_target = adjoint(target_from_world * map.world_from_submap[to]);
      Quadratic& sum = sums[{from, to}];
      sum.information += twist_of_target.transpose() * measured.information * twist_of_target;
      // Points of `to` move with the twist; points of `from` move against it, as seen from `to`.
      sum.gradient +=
          (source_submap == to ? 1 : -1) * twist_of_target.transpose() * measured.gradient;
    }
  }
  return sums;
}

}  // namespace

std::vector<BundleLink> depth_links(const SparseMap& map,
                                    const std::vector<std::uint32_t>& submaps) {
  std::vector<std::int64_t> place_of_submap(map.world_from_submap.size(), -1);
  for (std::size_t i = 0; i < submaps.size(); ++i)
    place_of_submap[submaps[i]] = static_cast<std::int64_t>(i);
  std::vector<BundleLink> links;
  double chi2 = 0;
  for (const auto& [pair, sum] : measure_submaps(map, place_of_submap)) {
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(sum.information);
    const Vector6d& eigenvalues = solver.eigenvalues();
    const double least = kNoInformation * eigenvalues[5];
    const Vector6d inverse_eigenvalues =
        (eigenvalues.array() > least).select(eigenvalues.cwiseInverse(), 0.0);
    const Vector6d along = solver.eigenvectors().transpose() * sum.gradient;
    const Vector6d step = -(solver.eigenvectors() * inverse_eigenvalues.cwiseProduct(along));
    chi2 += along.dot(inverse_eigenvalues.cwiseProduct(along));
    const auto [from, to] = pair;
    links.push_back(
        {static_cast<std::uint32_t>(place_of_submap[from]),
         static_cast<std::uint32_t>(place_of_submap[to]),
         inverse(map.world_from_submap[from]) * map.world_from_submap[to] * exp_se3(step),
         (sum.information + sum.information.transpose()) / 2});
  }
  const double excess = std::max(1.0, chi2 / (6 * static_cast<double>(links.size())));
  for (BundleLink& link : links) link.information /= excess;
  return links;
}

}  // namespace hermite::adjust
