// The frames of a frame log again, for the worker that rebuilds a scan from them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "core/base/result.h"
#include "core/log/frame_log_reader.h"
#include "proto/wire/messages.h"

namespace hermite {

// Call from one thread.
class Replay {
 public:
  // The frames among the first `record_count` records; more may be written behind them meanwhile. 0: none, and the folder is not looked at.
  Replay(std::string log_folder, std::uint64_t record_count) : reader_(std::move(log_folder)), record_count_(record_count) {}

  // In order, without those that were refused. None: that was the last one. kIo or kCorruptData: the log is not any more what it was.
  Result<std::optional<wire::Frame>> next();

  // Leaves out the first `record_count` records; before next(). How many refused frames were among them. Errors as of next().
  Result<std::uint64_t> skip(std::uint64_t record_count);

 private:
  FrameLogReader reader_;
  const std::uint64_t record_count_;
};

}  // namespace hermite
