#include "core/track/kept_views.h"

#include <algorithm>
#include <cmath>

#include "core/track/twist_covariance.h"

namespace hermite::track {

namespace {

// Isotropic information that the image adds, as a share of that of depth along the normal.
constexpr double kImage = 0.02;

// Errors of a new view's surface in addition to the noise of the step: edges and corners of
// surfaces bias tracking through their effect on the map, the same way in each run, and more the
// farther the camera moves. Between the ground truth of rendered scenes and what calibration does
// not explain (tests/accuracy/LAB.md, "What is stated").
constexpr double kBias_m = 0.0006, kBiasGrowth = 0.004, kBiasTurn_m = 0.004;
constexpr double kBias_rad = 0.0004, kBiasGrowth_rad_per_m = 0.002, kBiasTurn = 0.003;

// The bias grows as fewer pixels constrain the camera: their errors come from few surfaces and do
// not cancel.
constexpr double kFullView = 0.5, kMostSparse = 3;

}  // namespace

KnownSurface known_surface(const ThinnedFrame& thinned_frame, std::span<const KeptView> views,
                           std::size_t first_view_count, const MapGround& ground) {
  const frame::CoarseView& seen = thinned_frame.seen;
  KnownSurface known;
  known.information.assign(views.size(), Matrix6d::Zero());
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen.depth_m[i] > 0) unknown.push_back(i);
  const std::size_t surface = known.surface_count = unknown.size();
  for (std::size_t k = 0; k < views.size() && !unknown.empty(); ++k) {
    if (!views[k].is_tracked_against(ground)) continue;
    const SharedGround pair(seen, thinned_frame.world_from_camera, views[k].seen,
                            views[k].world_from_camera(ground));
    if (!pair.may_meet()) continue;
    std::erase_if(unknown, [&](std::size_t i) {
      GroundMeeting meeting;
      if (!pair.meet(static_cast<int>(i % seen.camera.width),
                     static_cast<int>(i / seen.camera.width), meeting))
        return false;
      if (k < first_view_count) known.of_first_views.extend(meeting.point);
      const Eigen::Matrix<double, 3, 6> moved = moved_by_twist(meeting.point);
      const Eigen::Matrix3d held = meeting.weight * (meeting.normal * meeting.normal.transpose() +
                                                     kImage * Eigen::Matrix3d::Identity());
      const Eigen::Matrix<double, 6, 3> pulled = moved.transpose() * held;
      known.information[k] += pulled * moved;
      known.camera -= pulled * meeting.off_by_camera;
      return true;
    });
    known.whole += known.information[k];
  }
  known.known_share =
      surface > 0 ? 1 - static_cast<double>(unknown.size()) / static_cast<double>(surface) : 0;
  return known;
}

Matrix6d surface_bias(double surface_share, const Rigid3& last_from_camera,
                      const Eigen::Vector3d& position_world) {
  const double distance_m = last_from_camera.translation.norm(),
               turn_rad = angle_rad(last_from_camera.rotation);
  const double sparse =
      std::clamp(std::sqrt(kFullView / std::max(surface_share, 1e-3)), 1.0, kMostSparse);
  return isotropic(sparse * (kBias_m + kBiasGrowth * distance_m + kBiasTurn_m * turn_rad),
                   sparse * (kBias_rad + kBiasGrowth_rad_per_m * distance_m + kBiasTurn * turn_rad),
                   position_world);
}

double extent_m(std::span<const KeptView> views, const MapGround& ground) {
  Eigen::AlignedBox3d known;
  for (const KeptView& view : views) {
    const Rigid3 world_from_view = view.world_from_camera(ground);
    const frame::CoarseView& seen = view.seen;
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (seen.depth_m[i] > 0)
        known.extend(world_from_view * seen.point(static_cast<int>(i % seen.camera.width),
                                                  static_cast<int>(i / seen.camera.width)));
  }
  return known.isEmpty() ? 0 : known.sizes().maxCoeff();
}

std::vector<Eigen::Vector3d> positions_of(std::span<const KeptView> views,
                                          const MapGround& ground) {
  std::vector<Eigen::Vector3d> positions;
  for (const KeptView& view : views)
    positions.push_back(view.submap < ground.world_from_submap.size()
                            ? view.world_from_camera(ground).translation
                            : Eigen::Vector3d::Zero());
  return positions;
}

}  // namespace hermite::track
