// The part of Scans for scans that an earlier server left running.
#include <spdlog/spdlog.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "server/operations/logging.h"
#include "server/scan/checkpoint_file.h"
#include "server/scan/scans.h"
#include "server/store/unix_time.h"

namespace hermite {

// It counts for its token, as before the restart.
PlaceRequest Scans::place_of_left(const ScanRow& row) const {
  const ScanOwner owner = owner_of(row.token_id);
  return {owner.token_id, owner.is_admin, false};
}

// Every scan whose camera was admitted has its folder before its row, and loses it before its row. A row without a folder is of a scan
// that was refused, since its row could not be synced, while the disk has the row nevertheless; or of one that was discarded when the
// server died.
bool Scans::remove_refused(const ScanRow& row) {
  std::error_code error;
  if (row.to_be_rebuilt || std::filesystem::exists(data_.scan_folder(row.id), error) || error) return false;
  log_with({row.id}, spdlog::level::warn,
           fmt::format("scan {}: it has no folder, since it was refused or discarded; it is removed", row.id));
  (void)unstored_removals_.make(row);
  return true;
}

// The scan takes its place before any new camera.
void Scans::read_log(const ScanRow& row, const PlaceRequest& place, std::function<void(LeftScan)> then) {
  Launch launch;
  launch.row = row;
  launch.place = place;
  places_.began(row.id, place);
  logs_.read(
      row.id,
      [folder = data_.log_folder(row.id), events = log_events(launch)]() -> LogReaders::Opened { return FrameLog::open(folder, events); },
      [launch, then = std::move(then)](LogReaders::Opened opened) {
        then({launch, std::move(opened)});
      });
}

Status Scans::run_left(LeftScan left) {
  if (!left.opened.ok()) return left.opened.error();
  Launch& launch = left.launch;
  const LogContents contents = left.opened->contents;
  Result<ScanRecord> record = parse_scan_record(contents.terms, contents.start);
  if (!record.ok()) return record.error();
  launch.record = *std::move(record);
  launch.row.camera = launch.record.request.camera;  // the row lacks the lens distortion
  Result<Options> options = options_of(launch.record);
  if (!options.ok()) return options.error();
  launch.options = *options;
  launch.place.is_live = launch.record.request.mode == wire::Mode::kLive;
  const std::shared_ptr<LiveScan> scan = run(launch, *std::move(left.opened));
  spdlog::info("scan {} goes on: {} frames in its log{}{}", launch.row.id, contents.frame_count,
               contents.cut.empty() ? "" : "; cut: ", contents.cut);
  // Its camera was already told that it has ended.
  if (!contents.finished && launch.row.to_be_rebuilt)
    scan->end_with({ErrorCode::kIo, "the server's disk took no more frames"});
  else if (!contents.finished)
    scan->wait_for_camera({ErrorCode::kIo, "the server ended during the scan"});
  return Done{};
}

void Scans::interrupt_left(ScanRow row, const Error& why) {
  row.phase = ScanPhase::kInterrupted;
  row.message = "the server ended during the scan, and cannot be continued: " + why.message;
  row.finished_at_ms = unix_now_ms();
  row.to_be_rebuilt = row.to_be_rebuilt && why.code == ErrorCode::kIo;  // with other errors its frames are unusable
  log_with({row.id}, spdlog::level::warn, fmt::format("scan {}: {}", row.id, row.message));
  (void)unstored_ends_.make(row);
  rebuild_ended(row);
  if (Status status = blobs_.remove(row.id, kCheckpointName); !status.ok()) spdlog::warn("{}", status.error().message);
  places_.ended(row.id);
  places_.serve();
}

// The scan is no longer wanted and not running.
void Scans::drop_left(const std::string& scan_id) {
  logs_.drop(scan_id);
  left_for_jobs_.erase(scan_id);
  places_.ended(scan_id);
}

}  // namespace hermite
