// Scans that go on from their frame logs: those that an earlier server left running, those of jobs,
// and those whose results could not be stored and are made again. Logs are read in the background,
// one after another. Belongs to the network thread.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>

#include "core/base/result.h"
#include "server/access/places.h"
#include "server/disk/log_readers.h"
#include "server/disk/storage.h"
#include "server/scan/scan_launcher.h"
#include "server/scan/scan_room.h"
#include "server/scan/scan_rows.h"
#include "server/scan/shown_scans.h"

namespace hermite::server {

class LeftScans {
 public:
  // All of it outlives this.
  struct World {
    ScanLauncher& launcher;
    ScanRows& rows;
    const ScanRoom& room;
    Places& places;
    LogReaders& logs;
    ShownScans& shown;
  };
  LeftScans(const Storage& storage, const World& world) : storage_(storage), world_(world) {}

  // Continues all scans that an earlier server left running, the oldest first; those without a
  // usable log become interrupted. Throws SetupError when the store fails.
  void go_on_with_all();

  // The scan of a job: whether its log is being read, was read, or else begins to be read; and
  // whether it runs, once it was read.
  bool has(const std::string& scan_id) const;
  bool is_read(const std::string& scan_id) const { return read_for_jobs_.contains(scan_id); }
  void read_for_job(const ScanRow& row);
  bool run_for_job(const std::string& scan_id);

  // The scan is no longer wanted and not running.
  void drop(const std::string& scan_id);

  // To be called every few seconds while scans may start: makes the results of one ended scan
  // again, if there is room for it after everyone who waits for a place, and results can be stored.
  void rebuild_next(std::chrono::steady_clock::time_point now);
  // To be called with every scan that has ended.
  void ended(const ScanRow& row);

 private:
  struct LeftScan {
    Launch launch;
    LogReaders::Opened opened;
  };
  bool remove_refused(const ScanRow& row);
  void go_on_with(const ScanRow& row, const PlaceRequest& place);
  void read_log(const ScanRow& row, const PlaceRequest& place, std::function<void(LeftScan)> then);
  Status run(LeftScan left);
  void interrupt(ScanRow row, const Error& why);

  const Storage storage_;
  const World world_;
  std::map<std::string, LeftScan> read_for_jobs_;  // by id
  // The scan whose results are being made again; empty: none.
  std::string rebuilding_;
  std::chrono::steady_clock::time_point rebuild_at_;
  std::chrono::seconds rebuild_pause_{0};
};

}  // namespace hermite::server
