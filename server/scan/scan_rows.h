// The rows of scans as they are: as stored, completed with what the store does not have. These are
// the present counts of running scans, and the ends and removals that a database without room could
// not take yet. Belongs to the network thread.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/disk/pending_changes.h"
#include "server/scan/live_scan.h"
#include "server/store/store.h"

namespace hermite::server {

using RunningScans = std::map<std::string, std::shared_ptr<LiveScan>>;  // by id

// The owner of a scan, for its row and the storage quota.
struct ScanOwner {
  std::string token_id;
  bool is_admin = false;
};

class ScanRows {
 public:
  // Both outlive this.
  ScanRows(Store& store, const RunningScans& running);

  // As ScanTable: the newest scans for an empty id.
  Result<std::vector<ScanRow>> list(const std::string& older_than_id = "");
  Result<ScanRow> find(const std::string& scan_id);
  Status label(const std::string& scan_id, const ScanLabels& labels);  // kNotFound, kIo

  ScanRow as_it_is(ScanRow row) const;
  ScanOwner owner_of(const std::string& token_id) const;  // an unknown token is no administrator

  // Store the change now or later. Return the store's answer.
  Status end(const ScanRow& ended);
  Status remove(const ScanRow& row);

  // What was to be stored of a scan with this id is not any more, since it begins again.
  void begin_again(const std::string& scan_id);

  // Whether there is room for changes that the store may not take.
  bool has_room() const { return !ends_.full() && !removals_.full(); }
  bool all_ends_are_stored() const { return ends_.empty(); }
  void tick(std::chrono::steady_clock::time_point now);

 private:
  Store& store_;
  const RunningScans& running_;
  PendingChanges<ScanRow> ends_;      // otherwise an ended scan would be listed as running
  PendingChanges<ScanRow> removals_;  // not listed any more: their files are gone
};

}  // namespace hermite::server
