// Ended scans that viewers look at: their results are read again from the files, once for all
// viewers of a scan, and kept in memory as long as somebody looks. On the network thread, except
// where files are read.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "server/disk/log_readers.h"
#include "server/scan/stored_scan.h"
#include "server/scan/subscribers.h"
#include "server/store/blobs.h"
#include "server/store/store.h"

namespace hermite::server {

// The size of the files of points that are kept for viewers. A single scan is shown whatever its
// size.
inline constexpr std::uint64_t kMaxShown_bytes = std::uint64_t{1} << 30;

class ShownScans {
 public:
  // `find` returns the present row of a scan. `blobs` and what `find` uses outlive this.
  ShownScans(Blobs& blobs, const LogReaders::Threads& threads,
             std::function<Result<ScanRow>(const std::string& scan_id)> find,
             std::uint64_t most_bytes = kMaxShown_bytes);

  // Returns the subscribers of an ended scan; a failed one without files has only its state. None:
  // the files are being read in the background; call again from when_shown(). kBusy: too much is
  // shown already. kNotFound, and the other errors of `find`.
  Result<std::shared_ptr<Subscribers>> watch(const std::string& scan_id);
  using Ticket = std::uint64_t;
  Ticket when_shown(const std::string& scan_id, std::function<void()> then);  // called once, later
  void cancel(Ticket ticket);

  // Shows these to later viewers while somebody looks at them: those of a scan that has just ended.
  void keep(const std::string& scan_id, std::shared_ptr<Subscribers> subscribers) {
    shown_[scan_id] = std::move(subscribers);
  }

  // Later viewers get what is stored then. Present ones keep what they have.
  void forget(const std::string& scan_id) { shown_.erase(scan_id); }

  std::size_t viewer_count() const;

 private:
  // The sum of the sizes of what is read or shown; any thread.
  class Memory;
  struct Reading;
  void show(const std::string& scan_id, Result<Reading> reading);

  Blobs& blobs_;
  const LogReaders::Post post_, background_;
  const std::function<Result<ScanRow>(const std::string&)> find_;
  const std::shared_ptr<Memory> memory_;  // also held by what is shown
  std::map<std::string, std::weak_ptr<Subscribers>> shown_;
  std::map<std::string, std::map<Ticket, std::function<void()>>> being_read_;  // and who waits
  // While those who waited are told.
  std::map<std::string, Error> refused_;
  Ticket next_ticket_ = 0;
};

}  // namespace hermite::server
