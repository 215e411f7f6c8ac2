// The part of Scans for full disks and storage quotas: room is reserved for results, and results that could not be stored are made
// again.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/log/frame_log_format.h"
#include "server/scan/scans.h"

namespace hermite {

namespace {

// One segment of a frame log, the least that a scan needs to start. With less, users are warned.
constexpr std::uint64_t kRoomToBegin_bytes = kMaxSegmentBytes;
// Each attempt that fails to store its results costs a whole reconstruction.
constexpr std::chrono::seconds kFirstRebuildPause(5), kLongestRebuildPause(3600);

std::string in_megabytes(std::uint64_t bytes) { return std::to_string(bytes / 1'000'000) + " MB"; }

}  // namespace

std::uint64_t Scans::kept_back_bytes() const {
  std::uint64_t bytes = options_.min_free_disk_bytes;
  for (const auto& [id, scan] : running_) bytes += scan->results_bytes();
  return bytes;
}

Status Scans::check_disk() const { return check_disk_for(kRoomToBegin_bytes); }

Status Scans::check_disk_for(std::uint64_t bytes) const {
  const Result<std::uint64_t> free = data_.free_disk_bytes();
  if (!free.ok()) return free.error();
  const std::uint64_t kept_back = kept_back_bytes();
  if (*free >= kept_back + bytes) return Done{};
  return Error{ErrorCode::kBusy, "the server's disk has not enough room: " + in_megabytes(*free) + " are free; " + in_megabytes(kept_back) +
                                     " are kept back, also for results, and " + in_megabytes(bytes) + " are needed to begin"};
}

Scans::Room Scans::room_on_disk() const {
  const Result<std::uint64_t> free = data_.free_disk_bytes();
  if (!free.ok()) {
    spdlog::warn("{}", free.error().message);
    return {};
  }
  const std::uint64_t kept_back = kept_back_bytes();
  if (*free < kept_back)
    return {Error{ErrorCode::kIo, "the server's disk is nearly full: the " + in_megabytes(*free) + " that are left are kept for results"},
            {}};
  const std::uint64_t left_bytes = *free - kept_back;
  if (left_bytes >= kRoomToBegin_bytes) return {};
  return {{}, "the server's disk is nearly full: " + in_megabytes(left_bytes) + " are left for frames"};
}

// For scans of cameras. The scan of a job replaces its upload, which was counted when it arrived.
Scans::Room Scans::room_in_storage(const std::string& scan_id) const {
  const std::optional<PlaceRequest> place = places_.request_of(scan_id);
  if (!storage_.quota.has_limit() || !place || place->token_id.empty()) return {};
  ToCome results{0, 0};
  for (const auto& [id, scan] : running_) {
    const std::optional<PlaceRequest> other = places_.request_of(id);
    (other && other->token_id == place->token_id ? results.bytes : results.bytes_of_others) += scan->results_bytes();
  }
  const ScanOwner owner{place->token_id, place->is_admin};
  if (const Status fits = check_storage(owner, "", results); !fits.ok() && fits.error().code == ErrorCode::kBusy)
    return {Error{ErrorCode::kBusy, "there is no room for more frames: " + fits.error().message}, {}};
  results.bytes += kRoomToBegin_bytes;
  if (check_storage(owner, "", results).ok()) return {};
  return {{}, "the storage is nearly used up: less than " + in_megabytes(kRoomToBegin_bytes) + " are left for frames"};
}

// Ends scans while there is still room for the results of all of them; on a full disk no results could be stored.
void Scans::watch_room() {
  if (running_.empty()) return;
  const Room disk = room_on_disk();
  for (const auto& [id, scan] : running_) {
    const Room storage = disk.gone ? Room() : room_in_storage(id);
    const std::optional<Error>& gone = disk.gone ? disk.gone : storage.gone;
    if (gone)
      scan->no_more_room(*gone);
    else
      scan->warn(disk.warning.empty() ? storage.warning : disk.warning);
  }
}

// After everyone who waits for a place, and only with the room that a new scan needs and while results can be stored; otherwise it is
// retried.
void Scans::rebuild_next(LiveScan::Clock::time_point now) {
  if (stopping_ || now < rebuild_at_ || !rebuilding_.empty() || !unstored_ends_.empty()) return;
  const Result<std::optional<ScanRow>> found = store_.scans.next_to_rebuild();
  if (!found.ok()) return spdlog::warn("scans to be rebuilt: {}", found.error().message);
  if (!*found || !blobs_.availability().ok() || !places_.check_for_newcomer({}).ok() || !check_disk().ok()) return;
  ScanRow row = **found;
  row.phase = ScanPhase::kRunning;
  if (const Status begun = store_.scans.update(row); !begun.ok()) return spdlog::warn("scan {}: {}", row.id, begun.error().message);
  spdlog::info("scan {}: there is room again, its results are made from its frames", row.id);
  rebuilding_ = row.id;
  shown_.forget(row.id);
  read_log(row, {}, [this, row](LeftScan scan) {
    if (const Status status = run_left(std::move(scan)); !status.ok()) interrupt_left(row, status.error());
  });
}

void Scans::rebuild_ended(const ScanRow& row) {
  const bool again = rebuilding_ == row.id;
  if (again) rebuilding_.clear();
  if (!again && !row.to_be_rebuilt) return;
  rebuild_pause_ = again && row.to_be_rebuilt ? std::min(2 * rebuild_pause_, kLongestRebuildPause) : kFirstRebuildPause;
  rebuild_at_ = LiveScan::Clock::now() + rebuild_pause_;
}

}  // namespace hermite
