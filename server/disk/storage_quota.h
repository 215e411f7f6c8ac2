// How much the files of all scans and uploads may take together. Looking at every file of every scan may take seconds on a slow disk: that
// is done beside the network thread, now and then. So scans that run count as they were some seconds ago; what was removed is left out at
// once. Belongs to the network thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/disk/log_readers.h"
#include "server/store/shares.h"

namespace hermite {

// In bytes: one token may fill half of what there is, and a twentieth stays for administrators.
Share storage_share(std::uint64_t limit_bytes);

// Who wants more, and what is the token's already.
struct StorageAsker {
  bool is_admin = true;  // held to the limit for all alone
  std::vector<std::string> scan_ids = {};
  std::uint64_t upload_bytes = 0;
};

class StorageQuota {
 public:
  using Clock = std::chrono::steady_clock;
  using Sizes = std::map<std::string, std::uint64_t>;  // bytes of scans, by id

  // `measure` is called here once, and then in the background, one call at a time. Limit 0: there is none, and it is never called.
  StorageQuota(std::uint64_t limit_bytes, std::function<Result<Sizes>()> measure, LogReaders::Threads threads);

  // Whether so much more may come to the scans, `upload_bytes` of uploads being here or promised. kBusy, in words; kIo: it is not known
  // what there is.
  Status check(std::uint64_t upload_bytes, std::uint64_t more_bytes, const StorageAsker& asker = {}) const;
  bool has_limit() const { return limit_bytes_ > 0; }

  void removed(const std::string& scan_id);
  void files_changed();              // a scan has written results or an export: they count soon
  void tick(Clock::time_point now);  // now and then

 private:
  void measure(Clock::time_point now);
  void measured(Result<Sizes> sizes, Clock::duration took);

  const std::uint64_t limit_bytes_;
  const std::function<Result<Sizes>()> measure_;
  const LogReaders::Threads threads_;
  Result<Sizes> sizes_;
  std::set<std::string> removed_meanwhile_;  // since the measurement that is under way began
  bool measuring_ = false;
  bool outdated_ = false;  // something has changed
  Clock::time_point measure_at_;
};

}  // namespace hermite
