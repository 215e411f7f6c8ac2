// Where a job's frames come from: a recording that somebody has uploaded, or the frame log of a scan. They are what a camera would send.
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

namespace hermite {

// Call from one thread.
class JobFrames {
 public:
  virtual ~JobFrames() = default;
  virtual const wire::StartScan& request() const = 0;

  // Numbered 0, 1, 2, ... None: that was the last one.
  virtual Result<std::optional<wire::Frame>> next() = 0;
  virtual Status skip(std::uint64_t frame_count) = 0;

  // What there is to say about the frames so far; taken with it.
  virtual std::vector<std::string> take_remarks() = 0;
};

// As `hermite-client stream` sends them: the same bits for the pipeline.
std::unique_ptr<JobFrames> recorded_frames(Recording recording, wire::StartScan request);

// Of a scan that has ended, `frame_count` for its progress; `settings` instead of those that it had. kNotFound: there is no log any more.
Result<std::unique_ptr<JobFrames>> logged_frames(const std::string& log_folder, std::uint64_t frame_count, const wire::StartScan& request);

}  // namespace hermite
