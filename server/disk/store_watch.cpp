#include "server/disk/store_watch.h"

#include "server/operations/logging.h"

namespace hermite::server {

void StoreWatch::tick(Clock::time_point now) {
  if (checking_.valid() && checking_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    take_in(checking_.get(), now);
  if (checking_.valid() || now < next_at_) return;
  begun_at_ = now;
  checking_ = std::async(std::launch::async, [&store = store_] { return store.check_integrity(); });
}

void StoreWatch::take_in(const Status& found, Clock::time_point now) {
  const LogFields fields{{}, {}, std::chrono::duration<double>(now - begun_at_).count()};
  const bool told = found.ok() || found.error().code == ErrorCode::kCorruptData;
  next_at_ = now + (told ? kCheckPeriod : kCheckAgainAfter);
  if (!told)
    return log_with(fields, spdlog::level::warn,
                    "the database could not be checked: " + found.error().message);
  damage_.reset();
  if (found.ok())
    return log_with(fields, spdlog::level::info, "the database was checked and is whole");
  damage_ = found.error().message +
            "; restore a backup, or stop the server and move the database away: the scans' files "
            "are not in it";
  log_with(fields, spdlog::level::err, "the database: " + *damage_);
}

}  // namespace hermite::server
