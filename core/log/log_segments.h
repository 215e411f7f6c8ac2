// Appends records to the segments of a frame log and makes them durable. Blocks on the disk. Only
// for frame_log.cpp.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/log/frame_log.h"

namespace hermite::frame_log {

// Call it from one thread at a time. After an error it must not be used, because it is unknown how
// much of the last record is on disk.
class LogSegments {
 public:
  LogSegments(std::string folder, FrameLogOptions options);
  ~LogSegments();
  LogSegments(const LogSegments&) = delete;
  LogSegments& operator=(const LogSegments&) = delete;

  Status create();                        // creates the folder and its first segment
  Status continue_at(const LogEnd& end);  // truncates there
  Status append(RecordType type, std::string_view payload);
  Status sync();

 private:
  Status begin_segment(std::uint32_t segment);
  Status write_all(std::string_view bytes);
  Status remove_segments_after(std::uint32_t segment);

  const std::string folder_;
  const FrameLogOptions options_;
  std::uint32_t segment_ = 0;
  std::uint64_t offset_ = 0;  // bytes in the segment
  std::uint64_t record_count_ = 0;
  int file_ = -1;
};

}  // namespace hermite::frame_log
