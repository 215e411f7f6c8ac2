// Checks the integrity of the database: reads all of it on a separate thread when the server starts
// and then once a week, so that bits lost by a disk are found while there still is a backup from
// before. Belongs to the network thread, which it never blocks.
#pragma once

#include <chrono>
#include <future>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "server/store/store.h"

namespace hermite::server {

inline constexpr std::chrono::hours kCheckPeriod{7 * 24};
inline constexpr std::chrono::hours kCheckAgainAfter{1};  // if the check could not be made

class StoreWatch {
 public:
  using Clock = std::chrono::steady_clock;

  // `store` outlives this. The destructor waits for a running check.
  explicit StoreWatch(const Store& store) : store_(store) {}

  // To be called regularly: starts a check when one is due, and logs its result.
  void tick(Clock::time_point now);

  // Returns what the last check found, as text; std::nullopt if the database is intact or not
  // checked yet.
  const std::optional<std::string>& damage() const { return damage_; }

 private:
  void take_in(const Status& found, Clock::time_point now);

  const Store& store_;
  Clock::time_point begun_at_, next_at_{};  // the first check is due immediately
  std::optional<std::string> damage_;
  std::future<Status> checking_;
};

}  // namespace hermite::server
