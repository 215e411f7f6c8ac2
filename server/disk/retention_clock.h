// The time by which old things are removed. The clock of a machine may be wrong by years for an hour; what was removed in that hour is
// gone. So this time is never ahead of the clock, goes at most twice as fast as the server runs, and is kept in a file over restarts: the
// time in which the server did not run counts for a day at most, and what is missing is caught up with while it runs. Belongs to one
// thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace hermite {

class RetentionClock {
 public:
  using Steady = std::chrono::steady_clock;

  // `path`: where it is kept; a file that is not there or says nothing begins with the clock's time.
  RetentionClock(std::string path, std::int64_t clock_ms, Steady::time_point now);

  // Unix time, or earlier.
  std::int64_t now_ms() const { return now_ms_; }
  void tick(std::int64_t clock_ms, Steady::time_point now);

 private:
  void keep();

  const std::string path_;
  std::int64_t now_ms_;
  Steady::time_point ticked_at_;
  Steady::time_point kept_at_;
};

}  // namespace hermite
