#include "core/calibrate/view_choice.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/dataset/camera_velocity.h"

namespace hermite::calibrate {
namespace {

constexpr double kStep_rad = 8 * std::numbers::pi / 180, kStep_m = 0.15;

constexpr double kLeastOverlap = 0.25;
// The largest distance of a point from a surface it belongs to, above the errors of poses that a
// wrong camera has bent.
constexpr double kNear_m = 0.15;
constexpr int kLeastPoints = 50;
// Step in each direction of a patch grid: 4800 points of an image of 640x480. With a step of 8, a
// camera with depth in a tenth of the image, and one of 320x240 pixels, had too few points for any
// pair.
constexpr int kOverlapNode = 2;
constexpr std::uint32_t kHeldBackShare = 5;

// Returns the share of one view's points that lie on a surface of the other.
double overlap_of(const PatchGrid& grid, const std::vector<Facet>& of_first,
                  const std::vector<Facet>& of_second, const Rigid3& second_from_first,
                  const Camera& camera) {
  int all = 0, met = 0;
  for (int row = kOverlapNode / 2; row < grid.nodes.height; row += kOverlapNode)
    for (int column = kOverlapNode / 2; column < grid.nodes.width; column += kOverlapNode) {
      const Facet& facet = of_first[grid.nodes.index(column, row)];
      if (facet.point_m.z() <= 0) continue;
      ++all;
      const Eigen::Vector3d point = second_from_first * facet.point_m.cast<double>();
      if (point.z() < kNearestPatch_m / 2) continue;
      const Eigen::Array2d node =
          (camera.project(point).array() - grid.step_px / 2) / grid.step_px + 0.5;
      if (!(node.x() >= 0 && node.y() >= 0 && node.x() < grid.nodes.width &&
            node.y() < grid.nodes.height))
        continue;
      const Facet& there =
          of_second[grid.nodes.index(static_cast<int>(node.x()), static_cast<int>(node.y()))];
      if (there.point_m.z() <= 0) continue;
      const Eigen::Vector3d plane = there.plane_per_m.cast<double>();
      if (std::abs(plane.dot(point) - 1) < kNear_m * plane.norm()) ++met;
    }
  return all < kLeastPoints ? 0 : static_cast<double>(met) / all;
}

}  // namespace

bool is_another_view(const Rigid3& world_from_earlier, const Rigid3& world_from_camera) {
  const Rigid3 step = inverse(world_from_earlier) * world_from_camera;
  return angle_rad(step.rotation) / kStep_rad + step.translation.norm() / kStep_m >= 1;
}

std::vector<ChosenFrame> choose_frames(const dataset::Sequence& sequence, dataset::FrameRange range,
                                       const dataset::Trajectory& trajectory,
                                       std::size_t max_count) {
  std::vector<ChosenFrame> chosen;
  for (std::int64_t index = range.begin; index < range.end && chosen.size() < max_count; ++index) {
    const std::optional<Rigid3> pose =
        dataset::pose_at(trajectory, sequence.timestamp_s(index), dataset::kSameTime_s);
    if (!pose) continue;
    if (!chosen.empty() && !is_another_view(chosen.back().world_from_camera, *pose)) continue;
    chosen.push_back({index, *pose});
  }
  return chosen;
}

ChosenPairs choose_pairs(const std::vector<CalibrationView>& views, const Camera& camera) {
  std::vector<std::vector<Facet>> facets;
  for (const CalibrationView& view : views) facets.push_back(facets_of(view.patches, camera));
  ChosenPairs pairs;
  for (std::uint32_t second = 1; second < views.size(); ++second) {
    std::vector<std::uint32_t> overlapping;
    for (std::uint32_t first = 0; first < second; ++first) {
      const Rigid3 second_from_first =
          inverse(views[second].world_from_camera) * views[first].world_from_camera;
      if (overlap_of(views[first].patches, facets[first], facets[second], second_from_first,
                     camera) >= kLeastOverlap)
        overlapping.push_back(first);
    }
    const std::size_t count = std::min(kMostEarlierViews, overlapping.size());
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t first =
          overlapping[count < 2 ? 0 : i * (overlapping.size() - 1) / (count - 1)];
      // Holds out a fifth of the pairs of every spacing: 3 first + 2 spacing takes all remainders.
      const bool is_held_back = second - first > 1 && (first + 2 * second) % kHeldBackShare == 0;
      (is_held_back ? pairs.held_back : pairs.fitted).push_back({first, second});
    }
  }
  return pairs;
}

std::vector<ViewPair> pairs_of_half(const std::vector<ViewPair>& pairs, std::size_t view_count,
                                    bool is_second) {
  const std::size_t middle = view_count / 2;
  std::vector<ViewPair> half;
  for (const ViewPair& pair : pairs)
    if ((pair.first >= middle) == is_second && (pair.second >= middle) == is_second)
      half.push_back(pair);
  return half;
}

}  // namespace hermite::calibrate
