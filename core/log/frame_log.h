// The frames of one scan on disk, as they were received. Records reported as durable survive a
// crash of this process, and of the machine if its disk honours syncs. Format and rules:
// frame_log.md.
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

namespace hermite::frame_log {

// Both functions are called on the log's thread.
struct FrameLogEvents {
  // This many first frames of the scan, including rejected ones, are durable.
  std::function<void(std::uint64_t frame_count)> durable;
  // Called once; nothing more will be written or durable.
  std::function<void(const Error&)> failed;
};

struct FrameLogOptions {
  std::chrono::milliseconds group_time{100};  // longest time to a sync while records wait
  // Amount of waiting bytes that triggers a sync.
  std::size_t group_bytes = 1024 * 1024;
  // Limit of bytes not yet written: a scan's credit (128 MiB), one frame and a margin.
  std::size_t max_waiting_bytes = 192 * 1024 * 1024;
  std::uint64_t segment_bytes = kMaxSegmentBytes;
  // System calls, replaceable in tests of failing disks.
  std::function<ssize_t(int, const void*, std::size_t)> write = ::write;
  std::function<int(int)> sync = ::fdatasync;
};

// The contents of a log when it was opened.
struct LogContents {
  std::string terms, start;  // payloads of records 0 and 1
  std::uint64_t record_count = 0;
  std::uint64_t frame_count = 0;  // including rejected ones
  std::uint64_t refused_count = 0;
  std::string last_frame;  // payload of the last frame that was not rejected; empty: none
  bool finished = false;
  std::string cut;  // describes what was cut off; empty: nothing
};

class FrameLog {
 public:
  // Creates a log in `folder`, which must not exist; terms and start are durable on return. Returns
  // kIo when the disk fails.
  static Result<std::unique_ptr<FrameLog>> create(const std::string& folder,
                                                  const std::string& terms,
                                                  const std::string& start, FrameLogEvents events,
                                                  FrameLogOptions options = {});

  // Opens a log and truncates it at its first invalid record; the rest is durable on return. Blocks
  // while all of it is read. Returns kNotFound when there is no log, kCorruptData when its first
  // two records are invalid, and kIo when the disk fails.
  struct Opened;
  static Result<Opened> open(const std::string& folder, FrameLogEvents events,
                             FrameLogOptions options = {});

  ~FrameLog();  // as close(), for those who do not care whether all was written
  FrameLog(const FrameLog&) = delete;
  FrameLog& operator=(const FrameLog&) = delete;

  // Appends a record in the order of the calls. Returns kBusy when too many bytes wait to be
  // written. After a failure, returns that failure.
  Status append(RecordType type, std::string payload);

  // Writes and syncs waiting records, and ends the thread; nothing may be appended afterwards.
  // Returns the failure, also one of before, after which records are missing at the end of the log.
  Status close();

 private:
  struct Impl;
  explicit FrameLog(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

struct FrameLog::Opened {
  std::unique_ptr<FrameLog> log;
  LogContents contents;
};

}  // namespace hermite::frame_log
