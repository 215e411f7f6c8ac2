#include "server/client/progress.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "core/base/printf_text.h"
#include "server/client/link_adaption.h"

namespace hermite::client {
namespace {

constexpr double kTerminalInterval_s = 0.2;
constexpr double kPlainInterval_s = 5;
constexpr double kMaxShown_s = 100.0 * 3600;

// Rounds to centimetres and avoids "-0.00".
double rounded(double length_m) { return std::round(length_m * 100) / 100 + 0.0; }

std::string count_of(std::uint64_t count, const char* what) {
  return count == 0 ? std::string() : fmt::format("  {} {}", count, what);
}

// A mean over a shorter time is meaningless.
constexpr double kMinRateTime_s = 0.1;

double per_second(double amount, const StreamProgress& progress) {
  return progress.elapsed_s >= kMinRateTime_s ? amount / progress.elapsed_s : 0;
}

double sent_Mbit_per_s(const StreamProgress& progress) {
  return per_second(8e-6 * static_cast<double>(progress.sent_bytes), progress);
}

}  // namespace

std::string format_duration(double seconds) {
  const auto whole = static_cast<long long>(std::clamp(seconds, 0.0, kMaxShown_s) + 0.5);
  if (whole < 60) return printf_text("%lld s", whole);
  if (whole < 3600) return printf_text("%lld:%02lld", whole / 60, whole % 60);
  return printf_text("%lld:%02lld:%02lld", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string format_summary(const StreamProgress& progress) {
  std::string text = fmt::format("scan {} is finished: {} frames sent in {}, {} tracked",
                                 progress.scan_id, progress.sent_frames,
                                 format_duration(progress.elapsed_s), progress.tracked_frames);
  const std::uint64_t dropped = progress.dropped_frames + progress.server_dropped_frames;
  if (dropped > 0) text += fmt::format(", {} dropped", dropped);
  if (progress.left_out_frames > 0)
    text += fmt::format(", {} left out for a slow link", progress.left_out_frames);
  if (progress.problem_frames > 0)
    text += fmt::format(", {} with problems", progress.problem_frames);
  text += printf_text(", %.1f Mbit/s", sent_Mbit_per_s(progress));
  return progress.last_message.empty() ? text : text + "; " + progress.last_message;
}

// Empty before the first tracked frame.
std::string way_back_text(const wire::FrameResult& result) {
  if (!result.last_tracked) return {};
  return fmt::format(" - go back to what was seen {} ago",
                     format_duration(result.timestamp_s - result.last_tracked->timestamp_s));
}

std::string within_text(const wire::FrameResult& result) {
  if (!result.uncertainty) return {};
  const double within_mm = std::min(2000 * result.uncertainty->position_sigma_m, 1e6);
  return within_mm < 10 ? printf_text(" +-%.0f mm", std::max(1.0, within_mm))
                        : printf_text(" +-%.0f cm", within_mm / 10);
}

std::string tracking_text(const wire::FrameResult& result) {
  if (result.status == wire::TrackingStatus::kTracked) return "  tracked" + within_text(result);
  if (result.status == wire::TrackingStatus::kWeak) return "  weak: " + result.reason;
  return fmt::format("  LOST: {}{}", result.reason, way_back_text(result));
}

// Smaller corrections are not mentioned.
constexpr double kShownCorrection_m = 0.005;

std::string correction_text(double correction_m) {
  if (correction_m < kShownCorrection_m) return "the map was right";
  return "the map was corrected by up to " +
         printf_text("%.0f cm", std::min(100 * correction_m, 1e6));
}

std::string format_event(const wire::FrameResult& result) {
  const std::string frame = fmt::format("frame {}: ", result.sequence);
  switch (result.event) {
    case wire::MapEvent::kNone: break;
    case wire::MapEvent::kLost: return fmt::format("{}lost: {}", frame, result.reason);
    case wire::MapEvent::kFoundAgain: return frame + "found again";
    case wire::MapEvent::kNewPart:
      return frame + "a new part of the map begins: it will be joined when the camera sees both";
    case wire::MapEvent::kJoined: return frame + "two parts of the map are joined";
    case wire::MapEvent::kLoopClosed:
      return fmt::format("{}loop closed: {}", frame, correction_text(result.correction_m));
    case wire::MapEvent::kRecalibrated:
      return fmt::format("{}the camera's calibration was off and is corrected: {}", frame,
                         correction_text(result.correction_m));
  }
  return {};
}

std::string format_progress(const StreamProgress& progress) {
  const auto total = static_cast<std::uint64_t>(progress.frame_count);
  const double processed_per_s =
      per_second(static_cast<double>(progress.processed_frames), progress);
  std::string text = fmt::format(
      "frame {}/{} (sent {}){}", progress.processed_frames, total, progress.sent_frames,
      printf_text("  %.1f fps  %.1f Mbit/s", processed_per_s, sent_Mbit_per_s(progress)));
  if (progress.last_result) {
    const auto& position_m = progress.last_result->world_from_camera.translation;
    text += printf_text("  position %.2f %.2f %.2f m", rounded(position_m.x()),
                        rounded(position_m.y()), rounded(position_m.z()));
    text += tracking_text(*progress.last_result);
  }
  text += count_of(progress.dropped_frames + progress.server_dropped_frames, "dropped");
  text += count_of(progress.left_out_frames, "left out");
  text += count_of(progress.problem_frames, "with problems");
  if (progress.link_level > 0) text += "  slow link: " + as_text(link_level(progress.link_level));
  const std::uint64_t answered = progress.processed_frames + progress.server_dropped_frames;
  if (progress.finishing && answered >= progress.sent_frames) return text + "  finishing";
  const std::uint64_t done = answered + progress.dropped_frames + progress.left_out_frames;
  if (processed_per_s > 0 && done < total)
    text += fmt::format("  {} left",
                        format_duration(static_cast<double>(total - done) / processed_per_s));
  return text;
}

void ProgressPrinter::show(const StreamProgress& progress) {
  if (is_due(progress.elapsed_s)) show_now(progress);
}

void ProgressPrinter::show_now(const StreamProgress& progress) {
  write(progress.elapsed_s, format_progress(progress));
}

void ProgressPrinter::show(double now_s, const std::string& text) {
  if (is_due(now_s)) write(now_s, text);
}

bool ProgressPrinter::is_due(double now_s) const {
  return !shown_at_s_ ||
         now_s >= *shown_at_s_ + (is_terminal_ ? kTerminalInterval_s : kPlainInterval_s);
}

void ProgressPrinter::write(double now_s, const std::string& text) {
  shown_at_s_ = now_s;
  clear();
  out_ << text;
  line_is_open_ = is_terminal_;
  if (!is_terminal_) out_ << '\n';
  out_.flush();
}

void ProgressPrinter::line(const std::string& message) {
  clear();
  out_ << message << '\n';
  out_.flush();
}

void ProgressPrinter::clear() {
  if (line_is_open_) out_ << "\r\033[K";
  line_is_open_ = false;
}

}  // namespace hermite::client
