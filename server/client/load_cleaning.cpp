#include "server/client/load_cleaning.h"

#include <chrono>
#include <thread>

namespace hermite::client {

namespace {

constexpr std::chrono::minutes kCleaningPatience(2);
constexpr std::chrono::seconds kStopPatience(30);  // for the results of a scan that was stopped
constexpr std::chrono::milliseconds kStopPollPeriod(500);

// A scan whose camera has failed may still run on the server.
Status stop_and_delete(const ApiTarget& target, const std::string& scan_id,
                       const std::function<bool()>& give_up) {
  Status deleted = delete_scan(target, scan_id);
  if (deleted.ok() || deleted.error().code != ErrorCode::kBusy) return deleted;
  if (Status stopped = stop_scan(target, scan_id);
      !stopped.ok() && stopped.error().code != ErrorCode::kBusy)
    return stopped;
  const auto until = std::chrono::steady_clock::now() + kStopPatience;
  while (!deleted.ok() && deleted.error().code == ErrorCode::kBusy &&
         std::chrono::steady_clock::now() < until && !give_up()) {
    std::this_thread::sleep_for(kStopPollPeriod);
    deleted = delete_scan(target, scan_id);
  }
  return deleted;
}

}  // namespace

LoadCleaning clear_load_scans(const ApiTarget& target, const std::vector<std::string>& scan_ids,
                              bool keep, const std::function<bool()>& give_up) {
  LoadCleaning cleaning;
  const auto until = std::chrono::steady_clock::now() + kCleaningPatience;
  const auto enough = [&] { return give_up() || std::chrono::steady_clock::now() > until; };
  bool may_delete = !keep;
  if (keep) cleaning.why_left = "as you wished";
  for (const std::string& id : scan_ids) {
    if (may_delete && !enough()) {
      const Status deleted = stop_and_delete(target, id, enough);
      if (deleted.ok() || deleted.error().code == ErrorCode::kNotFound) {
        ++cleaning.deleted;
        continue;
      }
      may_delete = deleted.error().code != ErrorCode::kUnauthorized;
      cleaning.why_left =
          may_delete ? deleted.error().message : "deleting needs a token of scope admin";
    }
    if (cleaning.why_left.empty())
      cleaning.why_left = "it would have taken too long, or was interrupted";
    cleaning.left.push_back(id);
    // Their titles tell them as well, so that a failure does not matter.
    if (!enough()) static_cast<void>(tag_scan(target, id, {kLoadTag}));
  }
  return cleaning;
}

}  // namespace hermite::client
