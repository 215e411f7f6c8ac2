#include "core/dataset/trajectory.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/dataset/text_file.h"

namespace hermite::dataset {
namespace {

constexpr double kUnitLengthTolerance = 0.01;

Result<TimedPose> parse_pose_line(const TextLine& line) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  std::array<double, 8> values{};
  if (fields.size() != values.size())
    return line_error(
        "trajectory", line,
        "expected 8 numbers (time tx ty tz qx qy qz qw), found " + std::to_string(fields.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = parse_finite(fields[i]);
    if (!value)
      return line_error("trajectory", line, fmt::format("field {} is not a finite number", i + 1));
    values[i] = *value;
  }
  const Eigen::Quaterniond rotation(values[7], values[4], values[5], values[6]);
  if (!(std::abs(rotation.norm() - 1.0) <= kUnitLengthTolerance))
    return line_error("trajectory", line, "the quaternion's length is not 1 within 1 %");
  return TimedPose{values[0], {rotation.normalized(), {values[1], values[2], values[3]}}};
}

}  // namespace

Result<Trajectory> parse_tum_trajectory(const std::string& text) {
  Trajectory trajectory;
  for (const TextLine& line : data_lines(text)) {
    const Result<TimedPose> pose = parse_pose_line(line);
    if (!pose.ok()) return pose.error();
    if (!trajectory.empty() && pose->timestamp_s < trajectory.back().timestamp_s)
      return line_error("trajectory", line, "time runs backwards");
    trajectory.push_back(*pose);
  }
  return trajectory;
}

Result<Trajectory> read_tum_trajectory(const std::string& path) {
  const Result<std::string> text = read_text_file(path);
  if (!text.ok()) return text.error();
  Result<Trajectory> trajectory = parse_tum_trajectory(*text);
  if (!trajectory.ok()) return in_context(path, trajectory.error());
  return trajectory;
}

Status validate(const Trajectory& trajectory, const std::string& name) {
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (!std::isfinite(trajectory[i].timestamp_s) || !is_finite(trajectory[i].world_from_camera))
      return Error{ErrorCode::kInvalidArgument, fmt::format("{}: pose {} is not finite", name, i)};
    if (i > 0 && trajectory[i].timestamp_s < trajectory[i - 1].timestamp_s)
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("{}: time runs backwards at pose {}", name, i)};
  }
  return Done{};
}

std::optional<Rigid3> pose_at(const Trajectory& trajectory, double timestamp_s, double max_gap_s) {
  const auto after = std::lower_bound(
      trajectory.begin(), trajectory.end(), timestamp_s,
      [](const TimedPose& pose, double time_s) { return pose.timestamp_s < time_s; });
  const bool has_after = after != trajectory.end() && after->timestamp_s - timestamp_s <= max_gap_s;
  const bool has_before =
      after != trajectory.begin() && timestamp_s - std::prev(after)->timestamp_s <= max_gap_s;
  if (has_after && (!has_before || after->timestamp_s == timestamp_s))
    return after->world_from_camera;
  if (!has_before) return std::nullopt;
  const TimedPose& before = *std::prev(after);
  if (!has_after) return before.world_from_camera;
  const double share =
      (timestamp_s - before.timestamp_s) / (after->timestamp_s - before.timestamp_s);
  const Rigid3 &a = before.world_from_camera, &b = after->world_from_camera;
  return between(a, b, share);
}

std::string format_tum_trajectory(const Trajectory& trajectory) {
  std::string text = "# timestamp tx ty tz qx qy qz qw (world_from_camera, s and m)\n";
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector3d& t = pose.world_from_camera.translation;
    const Eigen::Quaterniond& q = pose.world_from_camera.rotation;
    // A double in %f needs at most 309 digits before the point.
    std::array<char, 8 * 330> line{};
    const int length =
        std::snprintf(line.data(), line.size(), "%.6f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                      pose.timestamp_s, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    text.append(line.data(), static_cast<std::size_t>(length));
  }
  return text;
}

}  // namespace hermite::dataset
