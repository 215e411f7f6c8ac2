#include "core/report/tracking_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>

#include "core/base/printf_text.h"

namespace hermite {

std::string format_tracking(const std::vector<AnchoredPose>& poses) {
  std::string text;
  for (const AnchoredPose& pose : poses) text += printf_text("%.6f %s\n", pose.timestamp_s, name_of(pose.status));
  return text;
}

Result<std::vector<TimedStatus>> parse_tracking(std::string_view text) {
  constexpr std::array kStatuses{TrackingStatus::kTracked, TrackingStatus::kWeak, TrackingStatus::kLost};
  std::vector<TimedStatus> statuses;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    TimedStatus frame;
    const auto [rest, problem] = std::from_chars(line.data(), line.data() + line.size(), frame.timestamp_s);
    const std::string_view behind = line.substr(static_cast<std::size_t>(rest - line.data()));
    const auto status = std::find_if(kStatuses.begin(), kStatuses.end(),
                                     [behind](TrackingStatus one) { return behind.starts_with(' ') && behind.substr(1) == name_of(one); });
    if (problem != std::errc() || status == kStatuses.end())
      return Error{ErrorCode::kCorruptData, "line " + std::to_string(statuses.size() + 1) + " is not a time and what became of the frame"};
    frame.status = *status;
    statuses.push_back(frame);
  }
  return statuses;
}

}  // namespace hermite
