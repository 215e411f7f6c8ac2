#include "core/dataset/accelerometer.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/dataset/text_file.h"

namespace hermite::dataset {

Eigen::Matrix3d camera_from_kinect_accelerometer() {
  return Eigen::Vector3d(-1, -1, 1).asDiagonal();
}

Result<std::vector<TimedAcceleration>> parse_accelerations(const std::string& text) {
  std::vector<TimedAcceleration> felt;
  for (const TextLine& line : data_lines(text)) {
    const auto fields = split_fields(line.text);
    std::vector<double> numbers;
    for (const std::string_view field : fields)
      if (const auto number = parse_finite(field)) numbers.push_back(*number);
    if (fields.size() != 4 || numbers.size() != 4)
      return line_error(kAccelerometerFile, line, "expected a time and three numbers");
    felt.push_back({numbers[0], {numbers[1], numbers[2], numbers[3]}});
  }
  std::ranges::stable_sort(felt, {}, &TimedAcceleration::timestamp_s);
  return felt;
}

std::string format_accelerations(const std::vector<TimedAcceleration>& felt) {
  std::string text = "# accelerometer data\n# timestamp ax ay az\n";
  for (const TimedAcceleration& one : felt) {
    const Eigen::Vector3d& a = one.acceleration_m_s2;
    text += fmt::format("{} {} {} {}\n", one.timestamp_s, a.x(), a.y(), a.z());
  }
  return text;
}

std::vector<std::optional<Eigen::Vector3d>> felt_before(
    const std::vector<double>& frame_times_s, const std::vector<TimedAcceleration>& felt) {
  std::vector<std::optional<Eigen::Vector3d>> means;
  means.reserve(frame_times_s.size());
  auto next = felt.begin();
  for (const double time_s : frame_times_s) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (; next != felt.end() && next->timestamp_s <= time_s; ++next) {
      if (next->timestamp_s <= time_s - kMostFelt_s) continue;
      sum += next->acceleration_m_s2;
      ++count;
    }
    means.push_back(count > 0 ? std::optional<Eigen::Vector3d>(sum / count) : std::nullopt);
  }
  return means;
}

}  // namespace hermite::dataset
