// Reads the frame logs of scans that an earlier server left, while the network thread has other things to do. A log may have gigabytes, and
// all of it is read before its scan can go on. Belongs to the network thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/log/frame_log.h"

namespace hermite {

// So long somebody waits for a log before he is told to come again: less than the 10 s that clients wait for an answer.
inline constexpr std::chrono::milliseconds kReadPatience(5000);
inline constexpr std::size_t kMaxLogsRead = 2;  // at once: a disk is faster at one thing after the other

class LogReaders {
 public:
  using Clock = std::chrono::steady_clock;
  using Opened = Result<FrameLog::Opened>;
  // Runs a function soon. Callable from every thread.
  using Post = std::function<void(std::function<void()>)>;
  struct Threads {
    Post network;
    Post background;  // one of a few threads that may wait for disks. What was posted there ends before this does, or never begins
  };

  // `room`: whether another scan may be gone on with, so many logs being read.
  LogReaders(Threads threads, std::function<bool(std::size_t reading_count)> room) : threads_(std::move(threads)), room_(std::move(room)) {}

  // First come, first read. `open` is called in the background, `then` here; neither after drop().
  void read(const std::string& scan_id, std::function<Opened()> open, std::function<void(Opened)> then);
  void drop(const std::string& scan_id);
  void go_on();  // there may be room again
  void stop();   // begins no more, and whoever waits for one is told

  bool is_waited_for(const std::string& scan_id) const { return wanted_.contains(scan_id); }
  std::size_t reading_count() const { return reading_count_; }

  // Calls `then` once, later: when that log was read, or was not within kReadPatience, or will not be.
  using Ticket = std::uint64_t;
  Ticket when_read(const std::string& scan_id, std::function<void()> then);
  void forget(Ticket ticket) { waiting_.erase(ticket); }
  void tick(Clock::time_point now);  // now and then

 private:
  struct Wanted {
    std::function<Opened()> open;
    std::function<void(Opened)> then;
  };
  struct Waiting {
    std::string scan_id;
    Clock::time_point since;
    std::function<void()> then;
  };
  void was_read(const std::string& scan_id, const std::shared_ptr<Wanted>& wanted, Opened opened);
  template <class Which>
  void wake(Which which);

  const Threads threads_;
  const std::function<bool(std::size_t)> room_;
  std::deque<std::string> line_;                           // not begun
  std::map<std::string, std::shared_ptr<Wanted>> wanted_;  // with those that are being read
  std::size_t reading_count_ = 0;
  std::map<Ticket, Waiting> waiting_;
  Ticket next_ticket_ = 0;
  bool stopping_ = false;
};

}  // namespace hermite
