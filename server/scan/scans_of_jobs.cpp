// The part of Scans for scans of jobs, and for admission.
#include <spdlog/spdlog.h>

#include "core/base/check.h"
#include "proto/wire/frame_payload.h"
#include "server/operations/logging.h"
#include "server/scan/scans.h"
#include "server/store/scan_id.h"

namespace hermite {

ScanOwner Scans::owner_of(const std::string& token_id) const {
  const Result<TokenRow> row = store_.tokens.find(token_id);
  return {token_id, row.ok() && row->scopes.admin};
}

Status Scans::check_storage(const ScanOwner& owner, const std::string& except_upload_id, const ToCome& to_come) const {
  if (!storage_.quota.has_limit()) return Done{};
  const Result<std::uint64_t> upload_bytes = data_.uploads_bytes(except_upload_id);
  if (!upload_bytes.ok()) return upload_bytes.error();
  Result<std::vector<std::string>> own_scans = store_.scans.of_token(owner.token_id);
  if (!own_scans.ok()) return own_scans.error();
  return storage_.quota.check(*upload_bytes + to_come.bytes_of_others, to_come.bytes, {owner.is_admin, *std::move(own_scans), 0});
}

Status Scans::check_storage_of(const std::string& scan_id) {
  const Result<ScanRow> row = find(scan_id);
  return row.ok() ? check_storage(owner_of(row->token_id), "", {}) : Status(row.error());
}

// After waiting cameras, and not when it would slow down a live scan. A scan left by an earlier server has its place already.
bool Scans::has_room_for(const std::string& scan_id) const {
  if (stopping_) return false;
  return logs_.is_waited_for(scan_id) || left_for_jobs_.contains(scan_id) || (places_.check_for_newcomer({}).ok() && check_disk().ok());
}

Result<std::optional<JobScan>> Scans::run_for_job(const std::string& scan_id, const std::string& upload_id, const ScanOwner& owner,
                                                  const wire::StartScan& request) {
  CHECK(has_room_for(scan_id), "a job waits for room");
  if (logs_.is_waited_for(scan_id)) return std::optional<JobScan>();
  if (Status status = check_storage(owner, upload_id, {}); !status.ok()) return status.error();
  auto read = left_for_jobs_.extract(scan_id);
  const Result<ScanRow> row = store_.scans.find(scan_id);
  if (read.empty() && row.ok() && row->phase == ScanPhase::kRunning) {
    read_log(*row, {}, [this](LeftScan left) { left_for_jobs_.insert_or_assign(left.launch.row.id, std::move(left)); });
    return std::optional<JobScan>();
  }
  if (read.empty() || !run_left(std::move(read.mapped())).ok()) {
    // Remains of a start that only created its folder, or of a scan that failed with the server.
    places_.ended(scan_id);
    if (Status status = remove_files_of_scan(storage_, scan_id); !status.ok()) return status.error();
    if (row.ok())
      if (Status status = store_.scans.remove(scan_id); !status.ok()) return status.error();
    // Nobody knows this token; it only makes the scan resumable, so that it stays running for the next server.
    const Result<Launch> launch = launch_of(scan_id, request, random_hex(kResumeTokenBytes), owner, {});
    if (!launch.ok()) return launch.error();
    if (const Result<std::shared_ptr<LiveScan>> scan = begin(*launch); !scan.ok()) return scan.error();
  }
  const std::shared_ptr<LiveScan> scan = running_.at(scan_id);
  const Result<wire::Resumed> resumed = scan->resume(0);
  if (!resumed.ok()) return resumed.error();
  return std::optional(JobScan{scan, resumed->next_sequence, resumed->frames_granted, wire::max_frame_message_bytes(request.camera)});
}

Status Scans::add_imported(const ScanRow& row, bool may_be_meshed) {
  if (Status added = store_.scans.add(row); !added.ok()) return added;
  unstored_removals_.forget(row.id);  // of an earlier attempt of the same job
  log_with({row.id}, spdlog::level::info, fmt::format("scan {} imported", row.id));
  metrics_.scan_ended(name_of(row.phase));
  storage_.quota.files_changed();
  if (may_be_meshed && finished_) finished_(row);
  return Done{};
}

Status Scans::check_room_for_import(const std::string& upload_id, const ScanOwner& owner, std::uint64_t bytes) const {
  if (Status storage = check_storage(owner, upload_id, {}); !storage.ok()) return storage;
  return check_disk_for(bytes);
}

void Scans::remove_unwanted(const std::string& scan_id) {
  CHECK(!running_.contains(scan_id), "a scan that runs is discarded");
  drop_left(scan_id);
  if (const Status removed = remove_files_of_scan(storage_, scan_id); !removed.ok()) spdlog::warn("{}", removed.error().message);
  shown_.forget(scan_id);
  unstored_ends_.forget(scan_id);
  ScanRow row;
  row.id = scan_id;
  (void)unstored_removals_.make(row);
}

}  // namespace hermite
