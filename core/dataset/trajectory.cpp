#include "core/dataset/trajectory.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "core/dataset/text_file.h"

namespace hermite {
namespace {

constexpr double kUnitLengthTolerance = 0.01;

Result<TimedPose> parse_pose_line(const TextLine& line) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  std::array<double, 8> values{};
  if (fields.size() != values.size())
    return line_error("trajectory", line, "expected 8 numbers (time tx ty tz qx qy qz qw), found " + std::to_string(fields.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = parse_finite(fields[i]);
    if (!value) return line_error("trajectory", line, "field " + std::to_string(i + 1) + " is not a finite number");
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

std::string format_tum_trajectory(const Trajectory& trajectory) {
  std::string text = "# timestamp tx ty tz qx qy qz qw (world_from_camera, s and m)\n";
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector3d& t = pose.world_from_camera.translation;
    const Eigen::Quaterniond& q = pose.world_from_camera.rotation;
    // Any double in %f needs at most 309 digits before the point.
    std::array<char, 8 * 330> line{};
    const int length = std::snprintf(line.data(), line.size(), "%.6f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", pose.timestamp_s, t.x(), t.y(),
                                     t.z(), q.x(), q.y(), q.z(), q.w());
    text.append(line.data(), static_cast<std::size_t>(length));
  }
  return text;
}

}  // namespace hermite
