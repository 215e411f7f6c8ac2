// What `hermite reconstruct` and `hermite calibrate` share: processing a recording in this process,
// without a server. Throws SetupError.
#pragma once

#include <fmt/core.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/read_ahead.h"
#include "core/dataset/frame_range.h"
#include "core/dataset/read_frame.h"
#include "core/dataset/sequence.h"
#include "core/pipeline/pipeline.h"
#include "core/report/frame_table.h"

namespace hermite::commands {

struct OfflineArguments {
  std::string sequence, camera, noise, frames, device;
  std::vector<std::string> settings;
  int gpu_memory_mb = 0;
};

inline constexpr const char* kSequenceHelp =
    "Recording (folder, file or archive; see hermite inspect) or synthetic[:key=value,...], behind "
    "it any of +noise=kinect, "
    "+covered=FROM:COUNT (a hand before the lens), +missing=FROM:COUNT, +exposure, +flicker, "
    "+vignetting, +person, +bend, +focal, "
    "+sparse, +skip, +rolling, +clock, +blur, +mirror, +glass";
inline constexpr const char* kCameraHelp =
    "camera.json, or one of fr1, fr2, fr3, icl-nuim, redwood";
inline constexpr const char* kNoiseHelp =
    "Add noise to the depth: kinect[,seed=N,steps_per_px=S], kinect-white[,seed=N,steps_per_px=S] "
    "or gaussian[,sigma_mm=S,seed=N]";

std::unique_ptr<dataset::Sequence> open_source(const OfflineArguments& arguments);
pipeline::Options options_of(const OfflineArguments& arguments);
// Returns every setting with its default, for the help.
std::string settings_table();

// A line that is overwritten, only on a terminal: in a log file it would be useless.
class Progress {
 public:
  explicit Progress(std::int64_t frame_count);
  void show(std::int64_t done, const std::string& text);
  void line(const std::string& text);

 private:
  using Clock = std::chrono::steady_clock;
  const bool on_terminal_;
  const std::int64_t frame_count_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point shown_at_;
};

inline constexpr std::size_t kFramesAhead = 4;

// Passes every frame of the range to `prepare` on a second thread, a few ahead, and then to `work`,
// which returns text for the progress line. So reconstruction waits neither for decoding nor for
// rectification.
template <class Prepare, class Work>
void for_each_frame(const dataset::Sequence& sequence, dataset::FrameRange range, Prepare prepare,
                    Work work) {
  struct Ready {
    std::int64_t index;
    std::string problem;
    decltype(prepare(frame::RgbdFrame())) frame;
  };
  ReadAhead<Ready> reader(range.begin, range.end, kFramesAhead, [&](std::int64_t index) {
    dataset::ReadFrame read = dataset::read_frame(sequence, index);
    return Ready{index, std::move(read.problem), prepare(std::move(read.frame))};
  });
  Progress progress(range.count());
  std::int64_t done = 0;
  while (std::optional<Ready> ready = reader.next()) {
    if (!ready->problem.empty())
      progress.line(fmt::format("frame {} cannot be read and counts as empty: {}", ready->index,
                                ready->problem));
    progress.show(++done, work(ready->index, std::move(ready->frame), progress));
  }
}

struct OfflineRun {
  std::unique_ptr<pipeline::Pipeline> pipeline;  // finished
  std::vector<report::FrameRow> rows;            // by frame of the range
};
OfflineRun reconstruct_frames(const dataset::Sequence& sequence, dataset::FrameRange range,
                              const pipeline::Options& options, const std::string& device);

// Returns the poses of the frames that were not lost, in the final map.
dataset::Trajectory tracked_poses(const OfflineRun& run);

}  // namespace hermite::commands
