#include "server/scan/scan_room.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "core/log/frame_log_format.h"
#include "server/store/disk_space.h"

namespace hermite::server {

namespace {

// One segment of a frame log, the least that a scan needs to start. With less, users are warned.
constexpr std::uint64_t kRoomToBegin_bytes = frame_log::kMaxSegmentBytes;

// Even many scans of 5 MB/s each use far less meanwhile than the room needed to start one.
constexpr std::chrono::seconds kRoomPeriod(1);

std::string in_megabytes(std::uint64_t bytes) { return fmt::format("{} MB", bytes / 1'000'000); }

}  // namespace

ScanRoom::ScanRoom(std::uint64_t min_free_disk_bytes, const Storage& storage, const Places& places,
                   ScanRows& rows, const RunningScans& running)
    : min_free_disk_bytes_(min_free_disk_bytes),
      storage_(storage),
      places_(places),
      rows_(rows),
      running_(running) {}

std::uint64_t ScanRoom::kept_back_bytes() const {
  std::uint64_t bytes = min_free_disk_bytes_;
  for (const auto& [id, scan] : running_) bytes += scan->results_bytes();
  return bytes;
}

Status ScanRoom::check_disk() const { return check_disk_for(kRoomToBegin_bytes); }

Status ScanRoom::check_disk_for(std::uint64_t bytes) const {
  const Result<std::uint64_t> free = free_bytes(storage_.data.path());
  if (!free.ok()) return free.error();
  const std::uint64_t kept_back = kept_back_bytes();
  if (*free >= kept_back + bytes) return Done{};
  return Error{ErrorCode::kBusy,
               fmt::format("the server's disk has not enough room: {} are free; {} are kept back, "
                           "also for results, and {} are needed to begin",
                           in_megabytes(*free), in_megabytes(kept_back), in_megabytes(bytes))};
}

ScanRoom::Room ScanRoom::room_on_disk() const {
  const Result<std::uint64_t> free = free_bytes(storage_.data.path());
  if (!free.ok()) {
    spdlog::warn("{}", free.error().message);
    return {};
  }
  const std::uint64_t kept_back = kept_back_bytes();
  if (*free < kept_back)
    return {Error{ErrorCode::kIo,
                  fmt::format(
                      "the server's disk is nearly full: the {} that are left are kept for results",
                      in_megabytes(*free))},
            {}};
  const std::uint64_t left_bytes = *free - kept_back;
  if (left_bytes >= kRoomToBegin_bytes) return {};
  return {{},
          fmt::format("the server's disk is nearly full: {} are left for frames",
                      in_megabytes(left_bytes))};
}

// For scans of cameras. The scan of a job replaces its upload, which was counted when it arrived.
ScanRoom::Room ScanRoom::room_in_storage(const std::string& scan_id) const {
  const std::optional<PlaceRequest> place = places_.request_of(scan_id);
  if (!storage_.quota.has_limit() || !place || place->token_id.empty()) return {};
  ToCome results{0, 0};
  for (const auto& [id, scan] : running_) {
    const std::optional<PlaceRequest> other = places_.request_of(id);
    (other && other->token_id == place->token_id ? results.bytes : results.bytes_of_others) +=
        scan->results_bytes();
  }
  const ScanOwner owner{place->token_id, place->is_admin};
  if (const Status fits = check_storage_for(owner, "", results);
      !fits.ok() && fits.error().code == ErrorCode::kBusy)
    return {Error{ErrorCode::kBusy, "there is no room for more frames: " + fits.error().message},
            {}};
  results.bytes += kRoomToBegin_bytes;
  if (check_storage_for(owner, "", results).ok()) return {};
  return {{},
          fmt::format("the storage is nearly used up: less than {} are left for frames",
                      in_megabytes(kRoomToBegin_bytes))};
}

Status ScanRoom::check_storage(const ScanOwner& owner, const std::string& except_upload_id) const {
  return check_storage_for(owner, except_upload_id, {});
}

Status ScanRoom::check_storage_for(const ScanOwner& owner, const std::string& except_upload_id,
                                   const ToCome& to_come) const {
  if (!storage_.quota.has_limit()) return Done{};
  const Result<std::uint64_t> upload_bytes = storage_.data.uploads_bytes(except_upload_id);
  if (!upload_bytes.ok()) return upload_bytes.error();
  Result<std::vector<std::string>> own_scans = storage_.store.scans.of_token(owner.token_id);
  if (!own_scans.ok()) return own_scans.error();
  return storage_.quota.check(*upload_bytes + to_come.bytes_of_others, to_come.bytes,
                              {owner.is_admin, *std::move(own_scans), 0});
}

Status ScanRoom::check_storage_of(const std::string& scan_id) {
  const Result<ScanRow> row = rows_.find(scan_id);
  return row.ok() ? check_storage(rows_.owner_of(row->token_id)) : Status(row.error());
}

Status ScanRoom::check_import(const std::string& upload_id, const ScanOwner& owner,
                              std::uint64_t bytes) const {
  if (Status storage = check_storage(owner, upload_id); !storage.ok()) return storage;
  return check_disk_for(bytes);
}

void ScanRoom::tick(std::chrono::steady_clock::time_point now) {
  if (now - watched_at_ < kRoomPeriod) return;
  watched_at_ = now;
  if (running_.empty()) return;
  const Room disk = room_on_disk();
  for (const auto& [id, scan] : running_) {
    const Room storage = disk.gone ? Room() : room_in_storage(id);
    const std::optional<Error>& gone = disk.gone ? disk.gone : storage.gone;
    if (gone)
      scan->end_early(*gone, EndCause::kNoRoom);
    else
      scan->display().warn(disk.warning.empty() ? storage.warning : disk.warning);
  }
}

}  // namespace hermite::server
