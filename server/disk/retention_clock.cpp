#include "server/disk/retention_clock.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <fstream>

#include "core/output/ply.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

constexpr std::int64_t kDowntimeCredit_ms = kDay_ms;
constexpr int kCatchUp = 2;                      // how many times faster than real time
constexpr std::chrono::minutes kKeepPeriod(10);  // the time that a crash loses is caught up

}  // namespace

RetentionClock::RetentionClock(std::string path, std::int64_t clock_ms, Steady::time_point now)
    : path_(std::move(path)), now_ms_(clock_ms), ticked_at_(now), kept_at_(now) {
  std::int64_t kept_ms = 0;
  if (std::ifstream(path_) >> kept_ms && kept_ms > 0)
    now_ms_ = std::min(clock_ms, kept_ms + kDowntimeCredit_ms);
  if (clock_ms - now_ms_ > kDay_ms)
    spdlog::warn(
        "the clock is {} days ahead of when this server ran last: what is old is removed bit by "
        "bit",
        (clock_ms - now_ms_) / kDay_ms);
  keep();
}

void RetentionClock::tick(std::int64_t clock_ms, Steady::time_point now) {
  const auto passed_ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(now - ticked_at_).count();
  if (passed_ms <= 0) return;
  ticked_at_ = now;
  now_ms_ = std::min(clock_ms, now_ms_ + kCatchUp * passed_ms);
  if (now - kept_at_ < kKeepPeriod) return;
  kept_at_ = now;
  keep();
}

void RetentionClock::keep() {
  if (const Status kept = output::write_file_atomically(path_, fmt::format("{}\n", now_ms_));
      !kept.ok())
    spdlog::warn("{}", kept.error().message);
}

}  // namespace hermite::server
