// The clock for removing old data. The clock of a machine may be wrong by years for an hour, and
// what is removed in that hour is lost. So this clock is never ahead of the machine's, runs at most
// twice as fast as real time, and is stored in a file across restarts: time during which the server
// did not run counts for at most a day, and the rest is caught up while it runs. Belongs to one
// thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace hermite::server {

class RetentionClock {
 public:
  using Steady = std::chrono::steady_clock;

  // `path` is the file that stores it; without a valid file it starts with the machine's clock.
  RetentionClock(std::string path, std::int64_t clock_ms, Steady::time_point now);

  // Returns Unix time, or an earlier time.
  std::int64_t now_ms() const { return now_ms_; }
  void tick(std::int64_t clock_ms, Steady::time_point now);

 private:
  void keep();

  const std::string path_;
  std::int64_t now_ms_;
  Steady::time_point ticked_at_;
  Steady::time_point kept_at_;
};

}  // namespace hermite::server
