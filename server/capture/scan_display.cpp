#include "server/capture/scan_display.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/base/printf_text.h"
#include "server/client/link_adaption.h"
#include "server/client/progress.h"

namespace hermite::client {
namespace {

constexpr double kShownBehind_s = 0.05;  // shorter delays are not noticeable
constexpr double kMinRateTime_s = 0.1;   // a mean over a shorter time is meaningless
constexpr double kMaxShown_s = 1e6;
// One second of most cameras: typically sent but not yet reported durable.
constexpr std::uint64_t kOnTheirWay_frames = 30;

// Returns for example "0:42", the time since the first frame.
std::string clock_text(double time_s, const CaptureState& capture) {
  const auto whole = static_cast<long long>(std::clamp(time_s - capture.first_s, 0.0, kMaxShown_s));
  return printf_text("%lld:%02lld", whole / 60, whole % 60);
}

std::string tracking_text(const wire::FrameResult& result, const CaptureState& capture) {
  if (result.status == wire::TrackingStatus::kTracked) return "  tracked" + within_text(result);
  if (result.status == wire::TrackingStatus::kWeak) return "  weak: " + result.reason;
  const std::string lost = "  LOST: " + result.reason;
  return result.last_tracked ? fmt::format("{} - go back to what was seen at {}", lost,
                                           clock_text(result.last_tracked->timestamp_s, capture))
                             : lost;
}

// Without a recording, a slow link shows in the quality that is sent; with a recording, only here.
std::string log_text(const LocalLog::State& log, const StreamProgress& stream) {
  const std::uint64_t behind =
      log.durable_count - std::min(log.durable_count, stream.durable_frames);
  std::string text =
      fmt::format("  {} recorded, {} on the server", log.durable_count, stream.durable_frames);
  if (behind > kOnTheirWay_frames) text += fmt::format(": {} frames behind, catching up", behind);
  return text;
}

}  // namespace

std::string format_scan_progress(const ScanProgress& progress) {
  const CaptureState& capture = progress.capture;
  const StreamProgress& stream = progress.stream;
  std::string text = clock_text(capture.newest_s, capture);
  if (capture.ended)
    text += fmt::format("  {} frames", capture.frame_count);
  else if (capture.paused)
    text += "  paused: space goes on";
  else
    text += printf_text("  %.1f fps  %.0f %% depth", capture.rate_hz, 100 * capture.coverage);
  if (stream.last_result) {
    text += tracking_text(*stream.last_result, capture);
    const double behind_s = capture.newest_s - stream.last_result->timestamp_s;
    if (behind_s > kShownBehind_s)
      text += printf_text("  %.1f s behind", std::min(behind_s, kMaxShown_s));
  }
  if (stream.elapsed_s >= kMinRateTime_s)
    text += printf_text("  %.1f Mbit/s",
                        8e-6 * static_cast<double>(stream.sent_bytes) / stream.elapsed_s);
  if (stream.round_trip_ms)
    text += printf_text("  round trip %.0f ms", std::min(*stream.round_trip_ms, 1e6));
  if (progress.dropped_frames > 0) text += fmt::format("  {} dropped", progress.dropped_frames);
  if (stream.left_out_frames > 0) text += fmt::format("  {} left out", stream.left_out_frames);
  if (stream.link_level > 0) text += "  slow link: " + as_text(link_level(stream.link_level));
  if (progress.log) text += log_text(*progress.log, stream);
  return stream.finishing ? text + "  finishing" : text;
}

std::string format_scan_summary(const ScanProgress& progress, const std::string& record_folder) {
  std::string text =
      fmt::format("{} frames in {}", progress.capture.frame_count,
                  format_duration(progress.capture.newest_s - progress.capture.first_s));
  if (progress.dropped_frames > 0) text += fmt::format(", {} dropped", progress.dropped_frames);
  if (progress.log)
    text += fmt::format(", {} recorded in {}{}", progress.log->durable_count, record_folder,
                        printf_text(" (%.1f MB)", 1e-6 * static_cast<double>(progress.log->bytes)));
  if (progress.stream.scan_id.empty()) return text;
  return fmt::format(
      "{}; scan {}: {} processed, {} tracked{}", text, progress.stream.scan_id,
      progress.stream.processed_frames, progress.stream.tracked_frames,
      progress.stream.last_message.empty() ? "" : "; " + progress.stream.last_message);
}

}  // namespace hermite::client
