#include "core/calibrate/corner_matches.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "core/adjust/bundle_noise.h"

namespace hermite::calibrate {
namespace {

constexpr int kMostOctavesApart = 2;

// Points behind the camera are not visible, and the projection of points near it is too sensitive
// to errors.
constexpr double kNearestCorner_m = 0.2;

struct Nearest {
  std::uint32_t feature = 0;
  int distance = adjust::kDescriptorBits, second_distance = adjust::kDescriptorBits;
};

}  // namespace

std::optional<Eigen::Vector3d> point_of(const adjust::Feature& feature, const Camera& camera) {
  const double u = static_cast<double>(feature.pixel_px.x()),
               v = static_cast<double>(feature.pixel_px.y());
  const double depth_m =
      camera.depth_correction.true_depth_m(static_cast<double>(feature.depth_m), camera.rho2(u, v));
  if (!(depth_m > 0)) return std::nullopt;
  return camera.unproject(u, v, depth_m);
}

std::vector<adjust::LandmarkMatch> match_corners(const std::vector<adjust::Feature>& source,
                                                 const std::vector<adjust::Feature>& target,
                                                 const Rigid3& target_from_source,
                                                 const Camera& camera,
                                                 const MeasurementGates& gates) {
  const adjust::ProjectionOptions bounds;
  std::vector<std::optional<Eigen::Vector3d>> target_points;
  for (const adjust::Feature& feature : target) target_points.push_back(point_of(feature, camera));
  // Sorts by row, so that only features of nearby rows are compared.
  std::vector<std::uint32_t> by_row(target.size());
  std::iota(by_row.begin(), by_row.end(), 0u);
  const auto row_of = [&target](std::uint32_t j) { return target[j].pixel_px.y(); };
  std::ranges::stable_sort(by_row, {}, row_of);
  const float radius_px = static_cast<float>(gates.corner_px);
  std::vector<adjust::LandmarkMatch> matches;
  for (std::uint32_t i = 0; i < source.size(); ++i) {
    const std::optional<Eigen::Vector3d> own = point_of(source[i], camera);
    if (!own) continue;
    const Eigen::Vector3d point = target_from_source * *own;
    if (point.z() < kNearestCorner_m) continue;
    const Eigen::Vector2f at = camera.project(point).cast<float>();
    const double allowed_m = 2 * gates.surface_m + 3 * adjust::depth_deviation_m(point.z());
    Nearest nearest;
    for (auto next = std::ranges::lower_bound(by_row, at.y() - radius_px, {}, row_of);
         next != by_row.end(); ++next) {
      const std::uint32_t j = *next;
      if (row_of(j) > at.y() + radius_px) break;
      if ((target[j].pixel_px - at).squaredNorm() > radius_px * radius_px) continue;
      if (std::abs(int{target[j].octave} - int{source[i].octave}) > kMostOctavesApart) continue;
      if (target_points[j] && std::abs(target_points[j]->z() - point.z()) > allowed_m) continue;
      const int distance = adjust::hamming(target[j].descriptor, source[i].descriptor);
      if (distance < nearest.distance) {
        nearest = {j, distance, nearest.distance};
      } else if (distance < nearest.second_distance) {
        nearest.second_distance = distance;
      }
    }
    if (nearest.distance <= bounds.max_distance &&
        nearest.distance <= bounds.max_ratio * nearest.second_distance)
      matches.push_back({nearest.feature, i, nearest.distance});
  }
  return adjust::one_to_one(std::move(matches));
}

}  // namespace hermite::calibrate
