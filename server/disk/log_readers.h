// Reads the frame logs of scans that an earlier server left, without blocking the network thread. A
// log may have gigabytes, all of which are read before its scan can continue. Belongs to the
// network thread.
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

namespace hermite::server {

// How long a client waits for a log before it is told to come again: less than the 10 s that
// clients wait for an answer.
inline constexpr std::chrono::milliseconds kReadPatience(5000);
inline constexpr std::size_t kMaxLogsRead = 2;  // at once: a disk is faster at one after another

class LogReaders {
 public:
  using Clock = std::chrono::steady_clock;
  using Opened = Result<frame_log::FrameLog::Opened>;
  // Runs a function soon. Callable on every thread.
  using Post = std::function<void(std::function<void()>)>;
  struct Threads {
    Post network;
    // Runs the function on one of a few threads that may wait for disks. Posted functions end
    // before this object is destroyed, or never begin.
    Post background;
  };

  // `room` returns whether another scan may continue while `reading_count` logs are being read.
  LogReaders(Threads threads, std::function<bool(std::size_t reading_count)> room)
      : threads_(std::move(threads)), room_(std::move(room)) {}

  // Reads logs in the order of requests. `open` is called in the background, `then` on this thread;
  // neither after drop().
  void read(const std::string& scan_id, std::function<Opened()> open,
            std::function<void(Opened)> then);
  void drop(const std::string& scan_id);
  void go_on();  // to be called when there may be room again
  void stop();   // starts no more, and notifies all that wait for one

  bool is_waited_for(const std::string& scan_id) const { return wanted_.contains(scan_id); }
  std::size_t reading_count() const { return reading_count_; }

  // Identifies a call of when_read(), for forget().
  using Ticket = std::uint64_t;

  // Calls `then` once, later: when the log was read, was not read within kReadPatience, or will not
  // be read.
  Ticket when_read(const std::string& scan_id, std::function<void()> then);
  void forget(Ticket ticket) { waiting_.erase(ticket); }
  void tick(Clock::time_point now);  // to be called regularly

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
  std::deque<std::string> line_;                           // not started yet
  std::map<std::string, std::shared_ptr<Wanted>> wanted_;  // including those being read
  std::size_t reading_count_ = 0;
  std::map<Ticket, Waiting> waiting_;
  Ticket next_ticket_ = 0;
  bool stopping_ = false;
};

}  // namespace hermite::server
