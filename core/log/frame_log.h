// The frames of one scan on disk, as they were received: what is told to be durable here survives the death of this process, and that of
// the machine if its disk keeps its word. Format and rules: frame_log.md.
//
// A thread of its own writes and syncs in groups; append() never waits for the disk.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "core/log/frame_log_format.h"
#include "core/log/frame_log_reader.h"

namespace hermite {

// Both are called on the log's thread.
struct FrameLogEvents {
  std::function<void(std::uint64_t frame_count)> durable;  // the first so many frames of the scan (refused ones count) are
  std::function<void(const Error&)> failed;                // once: nothing more is written, or will be durable
};

struct FrameLogOptions {
  std::chrono::milliseconds group_time{100};          // a sync at least so often while something waits for one,
  std::size_t group_bytes = 1024 * 1024;              // and when so much does
  std::size_t max_waiting_bytes = 192 * 1024 * 1024;  // not yet written: a scan's credit (128 MiB) and one frame, with room
  std::uint64_t segment_bytes = kMaxSegmentBytes;
  // The system's calls, for tests of a disk that says no.
  std::function<ssize_t(int, const void*, std::size_t)> write = ::write;
  std::function<int(int)> sync = ::fdatasync;
};

// What was in a log when it was opened.
struct LogContents {
  std::string terms, start;  // payloads of records 0 and 1
  std::uint64_t record_count = 0;
  std::uint64_t frame_count = 0;  // with the refused ones
  std::uint64_t refused_count = 0;
  std::string last_frame;  // payload of the last one that was not refused; empty: none
  bool finished = false;
  std::string cut;  // words about what was cut off; empty: nothing
};

class FrameLog {
 public:
  // A new log in `folder`, which must not exist; terms and start are durable on return. kIo.
  static Result<std::unique_ptr<FrameLog>> create(const std::string& folder, const std::string& terms, const std::string& start,
                                                  FrameLogEvents events, FrameLogOptions options = {});

  // Cuts an existing log at its first bad record; all that is left is durable on return. Blocks while all of it is read.
  // kNotFound: there is none. kCorruptData: not even its first two records are good. kIo.
  struct Opened;
  static Result<Opened> open(const std::string& folder, FrameLogEvents events, FrameLogOptions options = {});

  ~FrameLog();  // writes and syncs what waits
  FrameLog(const FrameLog&) = delete;
  FrameLog& operator=(const FrameLog&) = delete;

  // In the order of the calls. kBusy: too much waits to be written. After a failure: that.
  Status append(RecordType type, std::string payload);

 private:
  struct Impl;
  explicit FrameLog(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

struct FrameLog::Opened {
  std::unique_ptr<FrameLog> log;
  LogContents contents;
};

}  // namespace hermite
