#include "core/evaluate/true_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/dataset/associate.h"
#include "core/dataset/counted_random.h"

namespace hermite {

namespace {

using Eigen::Vector3d;

constexpr std::int64_t kMostViews = 120;
constexpr double kNearestTruth_m = 0.4, kFarthestTruth_m = 4.5;
constexpr double kSameDepth_m = 0.01, kSameDepthShare = 0.01;

struct TrueView {
  DepthImage depth;
  Rigid3 true_from_camera, estimate_from_camera;
};

std::vector<TrueView> views_of(const Sequence& sequence, const Trajectory& estimate) {
  std::vector<TrueView> views;
  const std::int64_t stride = std::max<std::int64_t>(1, (sequence.frame_count() + kMostViews - 1) / kMostViews);
  for (std::int64_t i = 0; i < sequence.frame_count(); i += stride) {
    const auto truth = pose_at(sequence.groundtruth(), sequence.timestamp_s(i), kMaxAssociationGap_s);
    const auto found = pose_at(estimate, sequence.timestamp_s(i), kMaxAssociationGap_s);
    Result<RecordedFrame> frame = sequence.read(i);
    if (truth && found && frame.ok()) views.push_back({std::move(frame->depth), *truth, *found});
  }
  return views;
}

bool sees(const TrueView& view, const Camera& camera, const Vector3d& in_camera) {
  if (in_camera.z() < kNearestTruth_m) return false;
  const double x = std::round(camera.fx * in_camera.x() / in_camera.z() + camera.cx);
  const double y = std::round(camera.fy * in_camera.y() / in_camera.z() + camera.cy);
  if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) return false;
  const double depth_m = view.depth.at(static_cast<int>(x), static_cast<int>(y)) / camera.depth_units_per_metre;
  return std::abs(depth_m - in_camera.z()) <= kSameDepth_m + kSameDepthShare * in_camera.z();
}

}  // namespace

Result<std::vector<TruePoint>> true_points(const Sequence& sequence, const Trajectory& estimate, std::size_t count, std::uint64_t seed) {
  if (sequence.groundtruth().empty()) return Error{ErrorCode::kNotFound, sequence.name() + " has no true poses"};
  const Camera& camera = sequence.camera();
  const std::vector<TrueView> views = views_of(sequence, estimate);
  if (views.empty()) return Error{ErrorCode::kNotFound, "the trajectory has no pose at the time of a frame of " + sequence.name()};
  std::vector<TruePoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t key = frame_key(seed, static_cast<std::int64_t>(i));
    const auto below = [&](int limit, std::uint64_t counter) { return static_cast<int>(unit_uniform(key, counter) * limit); };
    const TrueView& chosen = views[static_cast<std::size_t>(below(static_cast<int>(views.size()), 0))];
    const int x = below(camera.width, 1), y = below(camera.height, 2);
    const double depth_m = chosen.depth.at(x, y) / camera.depth_units_per_metre;
    if (depth_m < kNearestTruth_m || depth_m > kFarthestTruth_m) continue;
    TruePoint point;
    point.true_m = chosen.true_from_camera * camera.unproject(x, y, depth_m);
    int seen = 0;
    for (const TrueView& view : views) {
      const Vector3d in_camera = inverse(view.true_from_camera) * point.true_m;
      if (!sees(view, camera, in_camera)) continue;
      point.estimated_m += view.estimate_from_camera * in_camera;
      ++seen;
    }
    if (seen == 0) continue;
    point.estimated_m /= seen;
    points.push_back(point);
  }
  return points;
}

}  // namespace hermite
