// What is left of scans that have ended: their last messages, results and frames. Belongs to the
// network thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/disk/log_readers.h"
#include "server/disk/storage.h"
#include "server/scan/scan_rows.h"

namespace hermite::server {

class EndedScans {
 public:
  // What is referred to outlives this. Frames are kept for so many days after the end of their
  // scan; 0: for ever.
  EndedScans(const Storage& storage, ScanRows& rows, const RunningScans& running,
             LogReaders::Threads threads, int keep_log_days)
      : storage_(storage),
        rows_(rows),
        running_(running),
        threads_(std::move(threads)),
        keep_log_days_(keep_log_days) {}

  // The final message to the camera of an ended scan, or why there is none: read in the background
  // and reported once, later.
  using LastMessages = Result<std::vector<wire::ServerMessage>>;
  using Ticket = std::uint64_t;
  Ticket when_told(const wire::ResumeScan& request, std::function<void(LastMessages)> then);
  void forget(Ticket ticket);  // cancels when_told()

  // The bytes of a result. kNotFound: no such scan or result.
  Result<std::uint64_t> size_of_result(const std::string& scan_id, const std::string& name);

  // Where the frames of a scan with that id (is_scan_id) are, or were.
  std::string log_folder(const std::string& scan_id) const {
    return storage_.data.log_folder(scan_id);
  }

  // To be called regularly: removes expired frames, by the given time (retention_clock.h).
  void tick(std::chrono::steady_clock::time_point now, std::int64_t now_ms);

 private:
  LastMessages last_messages(const ScanRow& row, const wire::ResumeScan& request) const;
  void remove_old_logs_of(const std::vector<std::string>& scan_ids, std::int64_t now_ms);

  const Storage storage_;
  ScanRows& rows_;
  const RunningScans& running_;
  const LogReaders::Threads threads_;
  const int keep_log_days_;
  std::map<Ticket, std::function<void(LastMessages)>> to_be_told_;
  Ticket next_ticket_ = 0;
  std::optional<std::chrono::steady_clock::time_point> old_logs_removed_at_;
};

}  // namespace hermite::server
