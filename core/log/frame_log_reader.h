// Reads a frame log from its beginning (format: frame_log.md). Holds one record at a time. Of a log that is still written it may be asked
// for those records that are durable: what is behind them may be half there.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/log/frame_log_format.h"

namespace hermite {

class SegmentFile;

struct LogRecord {
  RecordType type = RecordType::kFrame;
  std::uint64_t number = 0;
  std::string payload;
};

// Where the good part of a log ends.
struct LogEnd {
  std::uint32_t segment = 0;
  std::uint64_t offset = 0;  // bytes in that segment; 0: not even its header is good
  std::uint64_t record_count = 0;
  std::string words;  // what is there instead of a record, when it is not just the end
};

// Call from one thread.
class FrameLogReader {
 public:
  explicit FrameLogReader(std::string folder);
  ~FrameLogReader();
  FrameLogReader(const FrameLogReader&) = delete;
  FrameLogReader& operator=(const FrameLogReader&) = delete;

  // The next record; none at the end of the good part. kIo: the disk says no. kNotFound: there is no log in the folder.
  Result<std::optional<LogRecord>> next();

  // Behind the last record that next() gave.
  const LogEnd& end() const { return end_; }

 private:
  Result<bool> open_segment(std::uint32_t segment);
  std::optional<LogRecord> stop(std::string words);

  const std::string folder_;
  std::unique_ptr<SegmentFile> file_;  // the one that end_ is in
  bool stopped_ = false;
  LogEnd end_;
};

}  // namespace hermite
