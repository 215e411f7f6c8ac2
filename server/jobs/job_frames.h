// The source of a job's frames: an uploaded recording, or the frame log of a scan. Frames are
// messages as a camera would send them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/recording.h"
#include "proto/wire/messages.h"

namespace hermite::server {

// Call from one thread.
class JobFrames {
 public:
  virtual ~JobFrames() = default;
  virtual const wire::StartScan& request() const = 0;

  // The next frame, numbered 0, 1, 2, ... None: the end.
  virtual Result<std::optional<wire::Frame>> next() = 0;
  virtual Status skip(std::uint64_t frame_count) = 0;

  // Returns and clears remarks about the frames so far.
  virtual std::vector<std::string> take_remarks() = 0;
};

// The frames of a recording, as `hermite-client stream` sends them: the pipeline gets the same
// bits.
std::unique_ptr<JobFrames> recorded_frames(dataset::Recording recording, wire::StartScan request);

// The frames of a scan that has ended; `frame_count` is for progress; `request` replaces its
// settings. kNotFound: the log was removed.
Result<std::unique_ptr<JobFrames>> logged_frames(const std::string& log_folder,
                                                 std::uint64_t frame_count,
                                                 const wire::StartScan& request);

}  // namespace hermite::server
