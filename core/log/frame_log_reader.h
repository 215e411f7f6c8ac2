// Reads a frame log from its beginning (format: frame_log.md), with one record in memory at a time.
// While a log is being written, only its durable records may be read; later ones may be incomplete.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/log/frame_log_format.h"

namespace hermite::frame_log {

class SegmentFile;

struct LogRecord {
  RecordType type = RecordType::kFrame;
  std::uint64_t number = 0;
  std::string payload;
};

// The end of the valid part of a log.
struct LogEnd {
  std::uint32_t segment = 0;
  std::uint64_t offset = 0;  // bytes in that segment; 0: even its header is invalid
  std::uint64_t record_count = 0;
  std::string message;  // what is there instead of a record; empty at a regular end
};

// Call it from one thread.
class FrameLogReader {
 public:
  explicit FrameLogReader(std::string folder);
  ~FrameLogReader();
  FrameLogReader(const FrameLogReader&) = delete;
  FrameLogReader& operator=(const FrameLogReader&) = delete;

  // Returns the next record, or nullopt at the end of the valid part. Returns kIo when the disk
  // fails, and kNotFound when the folder has no log.
  Result<std::optional<LogRecord>> next();

  // The position after the last record from next().
  const LogEnd& end() const { return end_; }

 private:
  Result<bool> open_segment(std::uint32_t segment);
  std::optional<LogRecord> stop(std::string message);

  const std::string folder_;
  std::unique_ptr<SegmentFile> file_;  // the one that end_ is in
  bool stopped_ = false;
  LogEnd end_;
};

}  // namespace hermite::frame_log
