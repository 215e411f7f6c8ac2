#include "server/offline_run.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "core/disturb/depth_noise.h"
#include "core/run/back_end.h"
#include "core/source/open_sequence.h"

namespace hermite::commands {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMsPerProgress = 200;

std::string duration_text(double seconds) {
  const long total = static_cast<long>(seconds + 0.5);
  char text[32];
  if (total >= 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", total / 3600, total / 60 % 60, total % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld", total / 60, total % 60);
  }
  return text;
}

// Returns what is worth a separate line; empty if nothing is. `said`: the reason of the previous
// frame.
std::string remark_on(const pipeline::FrameResult& result, const std::string& said) {
  constexpr double kShownCorrection_m = 0.001;
  std::string remark = name_of(result.event);
  if (!remark.empty() && result.correction_m >= kShownCorrection_m) {
    char text[64];
    std::snprintf(text, sizeof text, ", the map moves by up to %.1f cm", 100 * result.correction_m);
    remark += text;
  }
  if (result.reason.empty() || result.reason == said) return remark;
  return (remark.empty() ? name_of(result.status) : remark) + ": " + result.reason;
}

std::vector<report::FrameRow> process_frames(const dataset::Sequence& sequence,
                                             dataset::FrameRange range,
                                             pipeline::Pipeline& pipeline) {
  std::vector<report::FrameRow> rows;
  std::string said;
  const auto prepare = [&pipeline](frame::RgbdFrame frame) {
    return pipeline.prepare(std::move(frame));
  };
  for_each_frame(
      sequence, range, prepare,
      [&](std::int64_t index, Result<frame::PreparedFrame> frame, Progress& progress) {
        const frame::PreparedFrame prepared = or_throw(std::move(frame));
        const Clock::time_point start = Clock::now();
        const pipeline::FrameResult result = or_throw(pipeline.process(prepared));
        rows.push_back(
            {result, std::chrono::duration<double, std::milli>(Clock::now() - start).count()});
        if (const std::string remark = remark_on(result, said); !remark.empty())
          progress.line(fmt::format("frame {} {}", index, remark));
        said = result.reason;
        return fmt::format("{} surfels{}", result.surfel_count,
                           result.status == track::TrackingStatus::kTracked
                               ? ""
                               : std::string("  ") + name_of(result.status));
      });
  return rows;
}

}  // namespace

std::unique_ptr<dataset::Sequence> open_source(const OfflineArguments& arguments) {
  std::optional<Camera> camera;
  if (!arguments.camera.empty()) camera = or_throw(dataset::read_camera(arguments.camera));
  std::unique_ptr<dataset::Sequence> sequence =
      or_throw(source::open_sequence(arguments.sequence, camera));
  if (arguments.noise.empty()) return sequence;
  return disturb::with_noise(std::move(sequence), or_throw(disturb::parse_noise(arguments.noise)));
}

pipeline::Options options_of(const OfflineArguments& arguments) {
  pipeline::Options options;
  for (const std::string& text : arguments.settings) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
      throw SetupError(
          {ErrorCode::kInvalidArgument, fmt::format("--set \"{}\": expected key=value", text)});
    or_throw(pipeline::apply_setting(options, text.substr(0, equals), text.substr(equals + 1)));
  }
  if (arguments.gpu_memory_mb > 0) options.map.gpu_memory_mb = arguments.gpu_memory_mb;
  return options;
}

std::string settings_table() {
  std::string table = "Settings for --set, with their defaults:\n";
  for (const pipeline::Setting& setting : pipeline::list_settings(pipeline::Options{})) {
    std::string key = fmt::format("  {}={}", setting.key, setting.value);
    key.resize(std::max<std::size_t>(key.size() + 2, 44), ' ');
    table += key + setting.description + "\n";
  }
  return table;
}

Progress::Progress(std::int64_t frame_count)
    : on_terminal_(isatty(STDERR_FILENO) != 0), frame_count_(frame_count) {}

void Progress::show(std::int64_t done, const std::string& text) {
  if (!on_terminal_) return;
  const Clock::time_point now = Clock::now();
  if (done < frame_count_ &&
      std::chrono::duration<double, std::milli>(now - shown_at_).count() < kMsPerProgress)
    return;
  shown_at_ = now;
  constexpr int kWidth = 24;
  const int filled = static_cast<int>(kWidth * done / frame_count_);
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double rate_hz = static_cast<double>(done) / std::max(elapsed_s, 1e-3);
  std::fprintf(stderr, "\r\033[K[%s%s] %lld/%lld  %.1f fps  %s left  %s",
               std::string(static_cast<std::size_t>(filled), '#').c_str(),
               std::string(static_cast<std::size_t>(kWidth - filled), '.').c_str(),
               static_cast<long long>(done), static_cast<long long>(frame_count_), rate_hz,
               duration_text(static_cast<double>(frame_count_ - done) / rate_hz).c_str(),
               text.c_str());
  if (done == frame_count_) std::fputc('\n', stderr);
}

void Progress::line(const std::string& text) {
  std::fprintf(stderr, "%s%s\n", on_terminal_ ? "\r\033[K" : "", text.c_str());
}

OfflineRun reconstruct_frames(const dataset::Sequence& sequence, dataset::FrameRange range,
                              const pipeline::Options& options, const std::string& device) {
  OfflineRun run;
  pipeline::BackEnd back_end = run::make_back_end(options, adjust::CorrectionTime::kByFrames);
  back_end.past_frames = [&sequence, range] {
    return [&sequence, range](std::int64_t frame_index, double) -> Result<frame::RgbdFrame> {
      return dataset::read_frame(sequence, range.begin + frame_index).frame;
    };
  };
  run.pipeline =
      std::make_unique<pipeline::Pipeline>(device, sequence.camera(), options, std::move(back_end));
  run.rows = process_frames(sequence, range, *run.pipeline);
  run.pipeline->finish();
  return run;
}

dataset::Trajectory tracked_poses(const OfflineRun& run) {
  dataset::Trajectory tracked;
  const dataset::Trajectory& all = run.pipeline->trajectory();
  for (std::size_t i = 0; i < run.rows.size(); ++i)
    if (run.rows[i].result.status != track::TrackingStatus::kLost) tracked.push_back(all[i]);
  return tracked;
}

}  // namespace hermite::commands
