#include "core/disturb/true_view.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>

namespace hermite::disturb {
namespace {

using Eigen::Vector3d;

constexpr double kMaxPoseGap_s = 0.1;
// If the horizontal part is below this, the view is taken to be straight up or down.
constexpr double kLeastHorizontal = 0.05;
constexpr int kUndistortSteps = 20;

Vector3d upright(const Vector3d& mean_up) {
  Eigen::Index axis = 0;
  mean_up.cwiseAbs().maxCoeff(&axis);
  Vector3d up = Vector3d::Zero();
  up[axis] = mean_up[axis] < 0 ? -1 : 1;
  return up;
}

}  // namespace

Vector3d forward_of(const Rigid3& world_from_camera, const Vector3d& up) {
  const auto horizontal = [&](const Vector3d& direction) -> Vector3d {
    return direction - direction.dot(up) * up;
  };
  const Vector3d view = horizontal(world_from_camera.rotation * Vector3d::UnitZ());
  if (view.norm() > kLeastHorizontal) return view.normalized();
  return horizontal(world_from_camera.rotation * -Vector3d::UnitY()).normalized();
}

Result<Stage> stage_of(const dataset::Sequence& sequence, const std::string& who) {
  const dataset::Trajectory& truth = sequence.groundtruth();
  if (truth.empty() || sequence.frame_count() == 0)
    return Error{ErrorCode::kInvalidArgument,
                 who + ": the sequence has no ground truth, which says where the camera is"};
  Vector3d mean_up = Vector3d::Zero();
  for (const dataset::TimedPose& pose : truth)
    mean_up -= pose.world_from_camera.rotation * Vector3d::UnitY();
  Stage stage;
  stage.middle_s = sequence.timestamp_s(sequence.frame_count() / 2);
  stage.world_from_camera =
      *dataset::pose_at(truth, stage.middle_s, std::numeric_limits<double>::infinity());
  stage.up = upright(mean_up);
  stage.forward = forward_of(stage.world_from_camera, stage.up);
  stage.side = stage.up.cross(stage.forward);
  return stage;
}

namespace {

// Returns the pose at a time outside of the two poses, at the velocity between them.
Rigid3 extrapolated(const dataset::TimedPose& end, const dataset::TimedPose& inner, double time_s) {
  const double share = (time_s - end.timestamp_s) / (inner.timestamp_s - end.timestamp_s);
  return end.world_from_camera *
         exp_se3(share * log_se3(inverse(end.world_from_camera) * inner.world_from_camera));
}

}  // namespace

// Before its first and after its last pose the camera goes on as it does beside them. If it stood
// still there, half of the rows of the first image would be taken by a camera at rest, as no image
// is.
Result<Rigid3> true_pose(const dataset::Sequence& sequence, double time_s, const std::string& who) {
  const dataset::Trajectory& truth = sequence.groundtruth();
  const auto pose = dataset::pose_at(truth, time_s, kMaxPoseGap_s);
  if (pose && truth.size() >= 2 && time_s < truth.front().timestamp_s)
    return extrapolated(truth[0], truth[1], time_s);
  if (pose && truth.size() >= 2 && time_s > truth.back().timestamp_s)
    return extrapolated(truth.back(), truth[truth.size() - 2], time_s);
  if (!pose)
    return Error{ErrorCode::kNotFound,
                 fmt::format("{}: the ground truth has no pose at {:f} s", who, time_s)};
  return *pose;
}

Status check_registered(const dataset::Sequence& sequence, const std::string& who) {
  if (!sequence.camera().color) return Done{};
  return Error{
      ErrorCode::kUnsupported,
      who + ": depth must be registered to colour, but a camera of its own takes the colour"};
}

Vector3d ray_of(const Camera& camera, int x, int y) {
  const Eigen::Vector2d seen((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy);
  Eigen::Vector2d straight = seen;
  if (camera.distortion != Distortion{})
    for (int step = 0; step < kUndistortSteps; ++step)
      straight += seen - camera.distortion.apply(straight.x(), straight.y());
  return {straight.x(), straight.y(), 1};
}

Image<Vector3d> rays_of(const Camera& camera) {
  Image<Vector3d> rays(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) rays.at(x, y) = ray_of(camera, x, y);
  return rays;
}

Eigen::Vector2d pixel_of(const Camera& camera, const Vector3d& point_in_camera) {
  const Eigen::Vector2d straight = camera.project(point_in_camera);
  return camera.distortion == Distortion{} ? straight : camera.distort(straight.x(), straight.y());
}

}  // namespace hermite::disturb
