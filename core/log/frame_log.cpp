#include "core/log/frame_log.h"

#include <fmt/core.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "core/log/log_segments.h"

namespace hermite::frame_log {

namespace {

using Clock = std::chrono::steady_clock;

struct Waiting {
  RecordType type;
  std::string payload;
};

bool is_frame(RecordType type) {
  return type == RecordType::kFrame || type == RecordType::kRefusedFrame;
}

void add_to(LogContents& contents, LogRecord record) {
  if (is_frame(record.type)) ++contents.frame_count;
  if (record.type == RecordType::kRefusedFrame) ++contents.refused_count;
  if (record.type == RecordType::kFinish) contents.finished = true;
  if (record.type == RecordType::kTerms) contents.terms = std::move(record.payload);
  if (record.type == RecordType::kStart) contents.start = std::move(record.payload);
  if (record.type == RecordType::kFrame) contents.last_frame = std::move(record.payload);
}

// Returns whether a record of this type may have this number.
bool in_place(RecordType type, std::uint64_t number) {
  return (type == RecordType::kTerms) == (number == 0) &&
         (type == RecordType::kStart) == (number == 1);
}

struct Survey {
  LogContents contents;
  LogEnd end;
};

// Reads the valid part of a log and finds its end.
Result<Survey> survey(const std::string& folder) {
  FrameLogReader reader(folder);
  Survey found;
  for (;;) {
    Result<std::optional<LogRecord>> record = reader.next();
    if (!record.ok()) return record.error();
    if (!*record) break;
    if (!in_place((*record)->type, (*record)->number))
      return Error{
          ErrorCode::kCorruptData,
          fmt::format("the log in {} does not begin with the records terms and start", folder)};
    add_to(found.contents, **std::move(record));
  }
  found.end = reader.end();
  found.contents.record_count = found.end.record_count;
  found.contents.cut = found.end.message;
  if (found.end.record_count < 2)
    return Error{ErrorCode::kCorruptData, fmt::format("the log in {} has no valid beginning: {}",
                                                      folder, found.end.message)};
  return found;
}

}  // namespace

struct FrameLog::Impl {
  const FrameLogEvents events;
  const FrameLogOptions options;
  LogSegments segments;           // this and the next two belong to the thread after the start
  std::uint64_t frame_count = 0;  // written
  std::size_t unsynced_bytes = 0;

  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Waiting> waiting;    // this and all members below are guarded by mutex
  std::size_t waiting_bytes = 0;  // including the batch that is being written
  bool stopping = false;
  std::optional<Error> failure;
  std::thread thread;

  Impl(const std::string& folder, FrameLogEvents log_events, FrameLogOptions log_options)
      : events(std::move(log_events)),
        options(log_options),
        segments(folder, std::move(log_options)) {}

  void run() {
    std::optional<Clock::time_point> sync_at;
    for (bool last = false; !last;) {
      std::deque<Waiting> batch;
      {
        std::unique_lock lock(mutex);
        const auto something = [this] { return stopping || !waiting.empty(); };
        if (sync_at) {
          changed.wait_until(lock, *sync_at, something);
        } else {
          changed.wait(lock, something);
        }
        batch = std::exchange(waiting, {});
        last = stopping;
      }
      Status status = write(batch);
      if (unsynced_bytes > 0 && !sync_at) sync_at = Clock::now() + options.group_time;
      const bool due =
          last || unsynced_bytes >= options.group_bytes || (sync_at && Clock::now() >= *sync_at);
      if (status.ok() && due && unsynced_bytes > 0) {
        status = sync();
        sync_at.reset();
      }
      if (!status.ok()) return fail(status.error());
    }
  }

  Status write(const std::deque<Waiting>& batch) {
    for (const Waiting& record : batch) {
      if (Status status = segments.append(record.type, record.payload); !status.ok()) return status;
      unsynced_bytes += kRecordHeaderBytes + record.payload.size();
      if (is_frame(record.type)) ++frame_count;
      const std::lock_guard lock(mutex);
      waiting_bytes -= record.payload.size();
    }
    return Done{};
  }

  Status sync() {
    if (Status status = segments.sync(); !status.ok()) return status;
    unsynced_bytes = 0;
    events.durable(frame_count);
    return Done{};
  }

  void fail(const Error& error) {
    {
      const std::lock_guard lock(mutex);
      failure = error;
      waiting.clear();
    }
    events.failed(error);
  }
};

FrameLog::FrameLog(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {
  impl_->thread = std::thread([running = impl_.get()] { running->run(); });
}

FrameLog::~FrameLog() { (void)close(); }

Status FrameLog::close() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stopping = true;
  }
  impl_->changed.notify_one();
  if (impl_->thread.joinable()) impl_->thread.join();
  return impl_->failure ? Status(*impl_->failure) : Status(Done{});
}

Result<std::unique_ptr<FrameLog>> FrameLog::create(const std::string& folder,
                                                   const std::string& terms,
                                                   const std::string& start, FrameLogEvents events,
                                                   FrameLogOptions options) {
  auto impl = std::make_unique<Impl>(folder, std::move(events), std::move(options));
  Status status = impl->segments.create();
  if (status.ok()) status = impl->segments.append(RecordType::kTerms, terms);
  if (status.ok()) status = impl->segments.append(RecordType::kStart, start);
  if (status.ok()) status = impl->segments.sync();
  if (!status.ok()) return status.error();
  return std::unique_ptr<FrameLog>(new FrameLog(std::move(impl)));
}

Result<FrameLog::Opened> FrameLog::open(const std::string& folder, FrameLogEvents events,
                                        FrameLogOptions options) {
  Result<Survey> found = survey(folder);
  if (!found.ok()) return found.error();
  auto impl = std::make_unique<Impl>(folder, std::move(events), std::move(options));
  if (Status status = impl->segments.continue_at(found->end); !status.ok()) return status.error();
  impl->frame_count = found->contents.frame_count;
  return Opened{std::unique_ptr<FrameLog>(new FrameLog(std::move(impl))),
                std::move(found->contents)};
}

Status FrameLog::append(RecordType type, std::string payload) {
  {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->failure) return *impl_->failure;
    if (impl_->waiting_bytes + payload.size() > impl_->options.max_waiting_bytes)
      return Error{
          ErrorCode::kBusy,
          fmt::format(
              "the disk is too slow: {} bytes of frames wait to be written, which is the limit",
              impl_->waiting_bytes)};
    impl_->waiting_bytes += payload.size();
    impl_->waiting.push_back({type, std::move(payload)});
  }
  impl_->changed.notify_one();
  return Done{};
}

}  // namespace hermite::frame_log
