#include "core/dataset/trajectory_formats.h"

#include <fmt/core.h>

#include <cstdio>

namespace hermite::dataset {
namespace {

std::string matrix_rows(const Rigid3& pose, int rows, const char* between) {
  const Eigen::Matrix4d matrix = pose.matrix();
  std::string text;
  for (int row = 0; row < rows; ++row) {
    char line[4 * 330];  // a double in %f needs at most 309 digits before the point
    std::snprintf(line, sizeof line, "%.9f %.9f %.9f %.9f", matrix(row, 0), matrix(row, 1),
                  matrix(row, 2), matrix(row, 3));
    text += (row > 0 ? between : "") + std::string(line);
  }
  return text + "\n";
}

bool same_pose(const Rigid3& a, const Rigid3& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

}  // namespace

std::string format_kitti_trajectory(const Trajectory& trajectory) {
  std::string text;
  for (const TimedPose& pose : trajectory) text += matrix_rows(pose.world_from_camera, 3, " ");
  return text;
}

std::string format_log_trajectory(const Trajectory& trajectory,
                                  const std::vector<std::int64_t>& frames) {
  CHECK(frames.size() == trajectory.size(), "a pose without the number of its frame");
  std::string text;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::string number = std::to_string(frames[i]);
    text += fmt::format("{} {} {}\n", number, number, frames[i] + 1);
    text += matrix_rows(trajectory[i].world_from_camera, 4, "\n");
  }
  return text;
}

std::vector<bool> tracked_frames(const Trajectory& trajectory) {
  std::vector<bool> tracked(trajectory.size(), true);
  for (std::size_t i = 1; i < trajectory.size(); ++i)
    tracked[i] = !same_pose(trajectory[i].world_from_camera, trajectory[i - 1].world_from_camera);
  if (tracked.size() > 1 && !tracked[1]) tracked[0] = false;
  return tracked;
}

}  // namespace hermite::dataset
