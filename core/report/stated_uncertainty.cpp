#include "core/report/stated_uncertainty.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace hermite::report {

namespace {

constexpr double kMaxGap_s = 0.020;  // as in the tools of the TUM benchmark

// The smallest variance, a tenth of a micrometre and microradian squared, which keeps the moment
// invertible where the stated uncertainty is zero.
constexpr double kLeast2 = 1e-14;

double mahalanobis(const Eigen::MatrixXd& moment, const Eigen::VectorXd& error) {
  const Eigen::MatrixXd regular =
      moment + kLeast2 * Eigen::MatrixXd::Identity(moment.rows(), moment.cols());
  return std::sqrt(std::max(0.0, error.dot(regular.ldlt().solve(error))));
}

StatedError error_of(const pipeline::FrameResult& result, const Rigid3& true_pose) {
  const Rigid3& stated = result.world_from_camera;
  Vector6d error;
  error << stated.translation - true_pose.translation,
      log_se3({stated.rotation * true_pose.rotation.conjugate(), Eigen::Vector3d::Zero()})
          .tail<3>();
  const Matrix6d& moment = result.uncertainty->second_moment;
  return {error.head<3>().norm(), error.tail<3>().norm(), mahalanobis(moment, error),
          mahalanobis(moment.topLeftCorner<3, 3>(), error.head<3>())};
}

}  // namespace

std::vector<std::optional<StatedError>> stated_errors(const std::vector<FrameRow>& rows,
                                                      const dataset::Trajectory& groundtruth) {
  std::vector<std::optional<StatedError>> errors(rows.size());
  std::optional<Rigid3> world_from_true_world;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const pipeline::FrameResult& result = rows[i].result;
    if (result.event == pipeline::MapEvent::kNewPart) world_from_true_world.reset();
    // Joined into a world with another first frame.
    if (result.event == pipeline::MapEvent::kJoined) break;
    const std::optional<Rigid3> true_pose =
        dataset::pose_at(groundtruth, result.timestamp_s, kMaxGap_s);
    if (!result.uncertainty || !true_pose) continue;
    if (world_from_true_world)
      errors[i] = error_of(result, *world_from_true_world * *true_pose);
    else
      world_from_true_world = result.world_from_camera * inverse(*true_pose);
  }
  return errors;
}

StatedShare share_inside(const std::vector<FrameRow>& rows,
                         const std::vector<std::optional<StatedError>>& errors) {
  StatedShare share;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!errors[i]) continue;
    const bool is_inside = errors[i]->pose_sigmas * errors[i]->pose_sigmas < track::kRegion99;
    const bool is_tracked = rows[i].result.status == track::TrackingStatus::kTracked;
    const bool is_wrong =
        errors[i]->position_m > kWrong_m || errors[i]->position_sigmas > kWrongSigmas;
    ++share.frame_count;
    share.inside_count += is_inside ? 1 : 0;
    share.tracked_count += is_tracked ? 1 : 0;
    share.tracked_inside_count += is_tracked && is_inside ? 1 : 0;
    share.tracked_wrong_count += is_tracked && is_wrong ? 1 : 0;
  }
  return share;
}

}  // namespace hermite::report
