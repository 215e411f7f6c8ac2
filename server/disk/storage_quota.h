// Limits the total size of the files of all scans and uploads. Looking at every file may take
// seconds on a slow disk, so it is done in the background from time to time. Running scans
// therefore count with their size of some seconds ago; removed ones stop counting immediately.
// Belongs to the network thread.
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

namespace hermite::server {

// Returns the share in bytes: one token may use half of the limit, and a twentieth is reserved for
// administrators.
Share storage_share(std::uint64_t limit_bytes);

// Who asks for more storage, and what its token already uses.
struct StorageAsker {
  bool is_admin = true;  // subject to the total limit only
  std::vector<std::string> scan_ids = {};
  std::uint64_t upload_bytes = 0;
};

class StorageQuota {
 public:
  using Clock = std::chrono::steady_clock;
  using Sizes = std::map<std::string, std::uint64_t>;  // size of scans in bytes, by id

  // `measure` is called by the constructor once, then in the background, one call at a time. Limit
  // 0: unlimited, and it is never called.
  StorageQuota(std::uint64_t limit_bytes, std::function<Result<Sizes>()> measure,
               LogReaders::Threads threads);

  // Checks whether `more_bytes` may be added, where `upload_bytes` is the size of uploads, stored
  // or promised. kBusy, with a message; kIo: the present size is unknown.
  Status check(std::uint64_t upload_bytes, std::uint64_t more_bytes,
               const StorageAsker& asker = {}) const;
  bool has_limit() const { return limit_bytes_ > 0; }

  void removed(const std::string& scan_id);
  void files_changed();              // a scan has written results or an export: measure again soon
  void tick(Clock::time_point now);  // to be called regularly

 private:
  void measure(Clock::time_point now);
  void measured(Result<Sizes> sizes, Clock::duration took);

  const std::uint64_t limit_bytes_;
  const std::function<Result<Sizes>()> measure_;
  const LogReaders::Threads threads_;
  Result<Sizes> sizes_;
  std::set<std::string> removed_meanwhile_;  // since the current measurement began
  bool measuring_ = false;
  bool outdated_ = false;  // files have changed since then
  Clock::time_point measure_at_;
};

}  // namespace hermite::server
