// Whether the database is whole: all of it is read on a thread of its own when the server starts, and once a week from then on. Bits that
// a disk has lost are found while there still is a backup from before. Belongs to the network thread; never blocks it.
#pragma once

#include <chrono>
#include <future>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "server/store/store.h"

namespace hermite {

inline constexpr std::chrono::hours kCheckPeriod{7 * 24};
inline constexpr std::chrono::hours kCheckAgainAfter{1};  // when nothing could be told

class StoreWatch {
 public:
  using Clock = std::chrono::steady_clock;

  // `store` outlives this. The end of this waits for a check that is on its way.
  explicit StoreWatch(const Store& store) : store_(store) {}

  void tick(Clock::time_point now);  // now and then: begins a check when it is time, and says in the log what came of it

  // What the last check has found, in words; nothing when all is well, or not known yet.
  const std::optional<std::string>& damage() const { return damage_; }

 private:
  void take_in(const Status& found, Clock::time_point now);

  const Store& store_;
  Clock::time_point begun_at_, next_at_{};  // at once
  std::optional<std::string> damage_;
  std::future<Status> checking_;
};

}  // namespace hermite
