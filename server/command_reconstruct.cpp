// hermite reconstruct
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <system_error>

#include "core/base/read_ahead.h"
#include "core/dataset/depth_noise.h"
#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"
#include "core/output/ply.h"
#include "core/pipeline/pipeline.h"
#include "core/raw/raw_frames.h"
#include "core/report/frame_table.h"
#include "server/commands.h"
#include "server/service/read_frame.h"
#include "server/service/results.h"

namespace hermite {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kFramesAhead = 4;
constexpr double kMsPerProgress = 200;

struct ReconstructArguments {
  std::string sequence;
  std::string out_folder;
  std::string raw_file;  // instead of out_folder
  std::string per_frame_file;
  std::string frames;
  std::string camera;
  std::string noise;
  std::string device;
  int gpu_memory_mb = 0;
  std::vector<std::string> settings;
};

std::unique_ptr<Sequence> open_source(const ReconstructArguments& arguments) {
  std::optional<Camera> camera;
  if (!arguments.camera.empty()) camera = or_throw(read_camera(arguments.camera));
  std::unique_ptr<Sequence> sequence = or_throw(open_sequence(arguments.sequence, camera));
  if (arguments.noise.empty()) return sequence;
  return with_noise(std::move(sequence), or_throw(parse_noise(arguments.noise)));
}

Options parse_options(const std::vector<std::string>& settings) {
  Options options;
  for (const std::string& text : settings) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw SetupError({ErrorCode::kInvalidArgument, "--set \"" + text + "\": expected key=value"});
    or_throw(apply_setting(options, text.substr(0, equals), text.substr(equals + 1)));
  }
  return options;
}

std::string duration_words(double seconds) {
  const long total = static_cast<long>(seconds + 0.5);
  char text[32];
  if (total >= 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", total / 3600, total / 60 % 60, total % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld", total / 60, total % 60);
  }
  return text;
}

// One line that is rewritten, on a terminal only: a log file has no use for it.
class Progress {
 public:
  explicit Progress(std::int64_t frame_count) : on_terminal_(isatty(STDERR_FILENO) != 0), frame_count_(frame_count) {}

  void show(std::int64_t done, const std::string& words) {
    if (!on_terminal_) return;
    const Clock::time_point now = Clock::now();
    if (done < frame_count_ && std::chrono::duration<double, std::milli>(now - shown_at_).count() < kMsPerProgress) return;
    shown_at_ = now;
    constexpr int kWidth = 24;
    const int filled = static_cast<int>(kWidth * done / frame_count_);
    const double elapsed_s = std::chrono::duration<double>(now - start_).count();
    const double rate_hz = static_cast<double>(done) / std::max(elapsed_s, 1e-3);
    std::fprintf(stderr, "\r\033[K[%s%s] %lld/%lld  %.1f fps  %s left  %s", std::string(static_cast<std::size_t>(filled), '#').c_str(),
                 std::string(static_cast<std::size_t>(kWidth - filled), '.').c_str(), static_cast<long long>(done),
                 static_cast<long long>(frame_count_), rate_hz, duration_words(static_cast<double>(frame_count_ - done) / rate_hz).c_str(),
                 words.c_str());
    if (done == frame_count_) std::fputc('\n', stderr);
  }

  void line(const std::string& words) { std::fprintf(stderr, "%s%s\n", on_terminal_ ? "\r\033[K" : "", words.c_str()); }

 private:
  const bool on_terminal_;
  const std::int64_t frame_count_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point shown_at_;
};

// Every frame of the range goes through `prepare` on a second thread, a few ahead, and then to `work`, which returns words for the line of
// progress: reconstruction waits neither for a PNG nor for a straight image.
template <class Prepare, class Work>
void for_each_frame(const Sequence& sequence, FrameRange range, Prepare prepare, Work work) {
  struct Ready {
    std::int64_t index;
    std::string problem;
    decltype(prepare(RgbdFrame())) frame;
  };
  ReadAhead<Ready> reader(range.begin, range.end, kFramesAhead, [&](std::int64_t index) {
    ReadFrame read = read_frame(sequence, index);
    return Ready{index, std::move(read.problem), prepare(std::move(read.frame))};
  });
  Progress progress(range.count());
  std::int64_t done = 0;
  while (std::optional<Ready> ready = reader.next()) {
    if (!ready->problem.empty())
      progress.line("frame " + std::to_string(ready->index) + " cannot be read and counts as empty: " + ready->problem);
    progress.show(++done, work(ready->index, std::move(ready->frame), progress));
  }
}

// What is worth a line of its own, or nothing. `said`: the reason of the frame before.
std::string remark_on(const FrameResult& result, const std::string& said) {
  constexpr double kShownCorrection_m = 0.001;
  std::string remark = name_of(result.event);
  if (!remark.empty() && result.correction_m >= kShownCorrection_m) {
    char words[64];
    std::snprintf(words, sizeof words, ", the map moves by up to %.1f cm", 100 * result.correction_m);
    remark += words;
  }
  if (result.reason.empty() || result.reason == said) return remark;
  return (remark.empty() ? name_of(result.status) : remark) + ": " + result.reason;
}

std::vector<FrameRow> process_frames(const Sequence& sequence, FrameRange range, Pipeline& pipeline) {
  std::vector<FrameRow> rows;
  std::string said;
  const auto prepare = [&pipeline](RgbdFrame frame) { return pipeline.prepare(std::move(frame)); };
  for_each_frame(sequence, range, prepare, [&](std::int64_t index, Result<PreparedFrame> frame, Progress& progress) {
    const PreparedFrame prepared = or_throw(std::move(frame));
    const Clock::time_point start = Clock::now();
    const FrameResult result = or_throw(pipeline.process(prepared));
    rows.push_back({result, std::chrono::duration<double, std::milli>(Clock::now() - start).count()});
    if (const std::string remark = remark_on(result, said); !remark.empty()) progress.line("frame " + std::to_string(index) + " " + remark);
    said = result.reason;
    return std::to_string(result.surfel_count) + " surfels" +
           (result.status == TrackingStatus::kTracked ? "" : std::string("  ") + name_of(result.status));
  });
  return rows;
}

int dump_raw(const std::string& path, const Sequence& sequence, FrameRange range) {
  RawFrameWriter writer = or_throw(RawFrameWriter::create(path, sequence.camera(), range.count()));
  const auto as_it_came = [](RgbdFrame frame) { return frame; };
  for_each_frame(sequence, range, as_it_came, [&writer](std::int64_t, const RgbdFrame& frame, Progress&) {
    or_throw(writer.append(frame));
    return std::string();
  });
  or_throw(writer.finish());
  std::cout << range.count() << " frames in " << path << '\n';
  return 0;
}

int run_reconstruct(const ReconstructArguments& arguments) {
  const std::unique_ptr<Sequence> sequence = open_source(arguments);
  const FrameRange range = or_throw(parse_frame_range(arguments.frames, sequence->frame_count()));
  if (!arguments.raw_file.empty()) return dump_raw(arguments.raw_file, *sequence, range);
  Options options = parse_options(arguments.settings);
  if (arguments.gpu_memory_mb > 0) options.map.gpu_memory_mb = arguments.gpu_memory_mb;
  std::error_code error;
  std::filesystem::create_directories(arguments.out_folder, error);
  if (error) throw SetupError({ErrorCode::kIo, "creating " + arguments.out_folder + ": " + error.message()});
  Pipeline pipeline(arguments.device, sequence->camera(), options,
                    make_mapping(sequence->camera(), options.adjust, CorrectionTime::kByFrames));
  const std::vector<FrameRow> rows = process_frames(*sequence, range, pipeline);
  pipeline.finish();
  if (!arguments.per_frame_file.empty()) or_throw(write_file_atomically(arguments.per_frame_file, format_frame_table(rows)));
  const RunResults results = or_throw(results_of(pipeline, options, sequence->groundtruth()));
  for (const auto& [name, bytes] : files_of(results)) or_throw(write_file_atomically(arguments.out_folder + "/" + name, bytes));
  std::cout << results.report_json;
  return 0;
}

std::string settings_table() {
  std::string table = "Settings for --set, with their defaults:\n";
  for (const Setting& setting : list_settings({})) {
    std::string key = "  " + setting.key + "=" + setting.value;
    key.resize(std::max<std::size_t>(key.size() + 2, 44), ' ');
    table += key + setting.description + "\n";
  }
  return table;
}

}  // namespace

Command add_reconstruct_command(CLI::App& app) {
  auto arguments = std::make_shared<ReconstructArguments>();
  CLI::App& reconstruct = *app.add_subcommand("reconstruct", "Reconstruct a recorded sequence here, without a server");
  reconstruct
      .add_option(
          "SEQUENCE", arguments->sequence,
          "Recording (folder, file or archive; see hermite inspect) or synthetic[:key=value,...], behind it any of +noise=kinect, "
          "+covered=FROM:COUNT (a hand before the lens), +missing=FROM:COUNT, +exposure, +flicker, +vignetting, +person, +bend, +focal, "
          "+sparse, +skip, +rolling, +clock, +blur, +mirror, +glass")
      ->required();
  CLI::Option_group& result = *reconstruct.add_option_group("Result", "One of these");
  result.require_option(1);
  result.add_option("--out", arguments->out_folder, "Folder for trajectory.txt, cloud.ply and report.json");
  CLI::Option* raw =
      result.add_option("--dump-raw", arguments->raw_file, "File for the decoded frames, which hermite_bench reads; reconstructs nothing");
  reconstruct.add_option("--frames", arguments->frames, "A:B takes frames A to B-1");
  reconstruct
      .add_option("--per-frame", arguments->per_frame_file,
                  "Write what became of each frame here, CSV: status, event, correction of the map, inliers, surfels, milliseconds, reason")
      ->excludes(raw);
  reconstruct.add_option("--set", arguments->settings, "Setting, key=value; may be repeated")->allow_extra_args(false)->excludes(raw);
  reconstruct.add_option("--gpu-memory", arguments->gpu_memory_mb, "Device memory of the scan [MB]; same as --set map.gpu_memory_mb=…")
      ->check(CLI::Range(0, 1'000'000))
      ->excludes(raw);
  reconstruct.add_option("--device", arguments->device, "GPU: an index or a part of its name (default: the best one)")->excludes(raw);
  reconstruct.add_option("--camera", arguments->camera, "camera.json, or one of fr1, fr2, fr3, icl-nuim, redwood");
  reconstruct.add_option("--noise", arguments->noise,
                         "Add noise to the depth: kinect[,seed=N], kinect-white[,seed=N] or gaussian,sigma_mm=S[,seed=N]");
  reconstruct.footer(settings_table());
  return {&reconstruct, [arguments] { return run_reconstruct(*arguments); }};
}

}  // namespace hermite
