// Reads the frames of a frame log, for a worker that rebuilds the scan.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "core/base/result.h"
#include "core/log/frame_log_reader.h"
#include "proto/wire/messages.h"

namespace hermite::server {

// Used by one thread.
class Replay {
 public:
  // The frames among the first `record_count` records; more may be appended meanwhile. With 0 there
  // are none and the folder is not opened.
  Replay(std::string log_folder, std::uint64_t record_count)
      : reader_(std::move(log_folder)), record_count_(record_count) {}

  // The next frame in order, without refused ones. None: the end. kIo, kCorruptData: the log was
  // damaged meanwhile.
  Result<std::optional<wire::Frame>> next();

  // Skips the first `record_count` records; call it before next(). Returns how many refused frames
  // were among them. Errors as of next().
  Result<std::uint64_t> skip(std::uint64_t record_count);

 private:
  frame_log::FrameLogReader reader_;
  const std::uint64_t record_count_;
};

}  // namespace hermite::server
