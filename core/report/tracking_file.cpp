#include "core/report/tracking_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

#include "core/base/printf_text.h"

namespace hermite::report {

namespace {

std::optional<track::TrackingStatus> status_named(std::string_view name) {
  for (const track::TrackingStatus status :
       {track::TrackingStatus::kTracked, track::TrackingStatus::kWeak,
        track::TrackingStatus::kLost})
    if (name == name_of(status)) return status;
  return std::nullopt;
}

}  // namespace

std::string format_tracking(const std::vector<pipeline::AnchoredPose>& poses,
                            const pipeline::ReasonTable& reasons) {
  std::string text;
  for (const pipeline::AnchoredPose& pose : poses) {
    text += printf_text("%.6f %s", pose.timestamp_s, name_of(pose.status));
    if (pose.reason != pipeline::kNoReason) text += " " + reasons.text_of(pose.reason);
    text += "\n";
  }
  return text;
}

Result<TrackingFile> parse_tracking(std::string_view text) {
  TrackingFile file;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const std::string line_name = "line " + std::to_string(file.frames.size() + 1);
    TimedStatus frame;
    const auto [rest, problem] =
        std::from_chars(line.data(), line.data() + line.size(), frame.timestamp_s);
    const std::string_view behind = line.substr(static_cast<std::size_t>(rest - line.data()));
    const std::size_t end = std::min(behind.find(' ', 1), behind.size());
    const std::optional<track::TrackingStatus> status =
        behind.starts_with(' ') ? status_named(behind.substr(1, end - 1)) : std::nullopt;
    if (problem != std::errc() || !status)
      return Error{ErrorCode::kCorruptData,
                   line_name + " is not a time and what became of the frame"};
    frame.status = *status;
    if (end < behind.size()) {
      const std::string reason(behind.substr(end + 1));
      if (!pipeline::is_reason(reason))
        return Error{ErrorCode::kCorruptData,
                     fmt::format("{} has a reason that is not 1 to {} bytes of text on one line",
                                 line_name, pipeline::kMaxReasonBytes)};
      frame.reason = file.reasons.number_of(reason);
    }
    file.frames.push_back(frame);
  }
  return file;
}

}  // namespace hermite::report
