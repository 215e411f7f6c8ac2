#include "server/scan/left_scans.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "server/operations/logging.h"
#include "server/scan/checkpoint_file.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

// Each attempt that fails to store its results costs a whole reconstruction.
constexpr std::chrono::seconds kFirstRebuildPause(5), kLongestRebuildPause(3600);

}  // namespace

void LeftScans::go_on_with_all() {
  const Result<std::vector<ScanRow>> left = storage_.store.scans.running();
  if (!left.ok()) throw SetupError(left.error());
  for (const ScanRow& row : *left) {
    if (remove_refused(row)) continue;
    // It counts for its token, as before the restart.
    const ScanOwner owner = world_.rows.owner_of(row.token_id);
    go_on_with(row, {owner.token_id, owner.is_admin, false});
  }
}

// Every scan whose camera was admitted has its folder before its row, and loses it before its row.
// A row without a folder is of a scan that was refused, since its row could not be synced, while
// the disk has the row nevertheless; or of one that was discarded when the server died.
bool LeftScans::remove_refused(const ScanRow& row) {
  std::error_code error;
  if (row.to_be_rebuilt || std::filesystem::exists(storage_.data.scan_folder(row.id), error) ||
      error)
    return false;
  log_with(
      {row.id}, spdlog::level::warn,
      fmt::format("scan {}: it has no folder, since it was refused or discarded; it is removed",
                  row.id));
  (void)world_.rows.remove(row);
  return true;
}

void LeftScans::go_on_with(const ScanRow& row, const PlaceRequest& place) {
  read_log(row, place, [this](LeftScan left) {
    const ScanRow left_row = left.launch.row;
    if (const Status status = run(std::move(left)); !status.ok())
      interrupt(left_row, status.error());
  });
}

// The scan takes its place before any new camera.
void LeftScans::read_log(const ScanRow& row, const PlaceRequest& place,
                         std::function<void(LeftScan)> then) {
  Launch launch;
  launch.row = row;
  launch.place = place;
  world_.places.began(row.id, place);
  world_.logs.read(
      row.id,
      [folder = storage_.data.log_folder(row.id), events = world_.launcher.log_events(launch)]()
          -> LogReaders::Opened { return frame_log::FrameLog::open(folder, events); },
      [launch, then = std::move(then)](LogReaders::Opened opened) {
        then({launch, std::move(opened)});
      });
}

Status LeftScans::run(LeftScan left) {
  if (!left.opened.ok()) return left.opened.error();
  Launch& launch = left.launch;
  const frame_log::LogContents contents = left.opened->contents;
  Result<ScanRecord> record = parse_scan_record(contents.terms, contents.start);
  if (!record.ok()) return record.error();
  launch.record = *std::move(record);
  launch.row.camera = launch.record.request.camera;  // the row lacks the lens distortion
  Result<pipeline::Options> options = options_of(launch.record);
  if (!options.ok()) return options.error();
  launch.options = *options;
  launch.place.is_live = launch.record.request.mode == wire::Mode::kLive;
  const std::shared_ptr<LiveScan> scan = world_.launcher.run(launch, *std::move(left.opened));
  spdlog::info("scan {} goes on: {} frames in its log{}{}", launch.row.id, contents.frame_count,
               contents.cut.empty() ? "" : "; cut: ", contents.cut);
  // Its camera was already told that it has ended.
  if (!contents.finished && launch.row.to_be_rebuilt)
    scan->end_early({ErrorCode::kIo, "the server's disk took no more frames"});
  else if (!contents.finished)
    scan->wait_for_camera({ErrorCode::kIo, "the server ended during the scan"});
  return Done{};
}

void LeftScans::interrupt(ScanRow row, const Error& why) {
  row.phase = ScanPhase::kInterrupted;
  row.message = "the server ended during the scan, and cannot be continued: " + why.message;
  row.finished_at_ms = unix_now_ms();
  // With other errors its frames are unusable.
  row.to_be_rebuilt = row.to_be_rebuilt && why.code == ErrorCode::kIo;
  log_with({row.id}, spdlog::level::warn, fmt::format("scan {}: {}", row.id, row.message));
  (void)world_.rows.end(row);
  ended(row);
  if (Status status = storage_.blobs.remove(row.id, kCheckpointName); !status.ok())
    spdlog::warn("{}", status.error().message);
  world_.places.ended(row.id);
  world_.places.serve();
}

bool LeftScans::has(const std::string& scan_id) const {
  return world_.logs.is_waited_for(scan_id) || is_read(scan_id);
}

void LeftScans::read_for_job(const ScanRow& row) {
  read_log(row, {}, [this](LeftScan left) {
    read_for_jobs_.insert_or_assign(left.launch.row.id, std::move(left));
  });
}

bool LeftScans::run_for_job(const std::string& scan_id) {
  auto read = read_for_jobs_.extract(scan_id);
  return !read.empty() && run(std::move(read.mapped())).ok();
}

void LeftScans::drop(const std::string& scan_id) {
  world_.logs.drop(scan_id);
  read_for_jobs_.erase(scan_id);
  world_.places.ended(scan_id);
}

// Comes after everyone who waits for a place, and only with the room that a new scan needs and
// while results can be stored; otherwise it is retried.
void LeftScans::rebuild_next(std::chrono::steady_clock::time_point now) {
  if (now < rebuild_at_ || !rebuilding_.empty() || !world_.rows.all_ends_are_stored()) return;
  const Result<std::optional<ScanRow>> found = storage_.store.scans.next_to_rebuild();
  if (!found.ok()) return spdlog::warn("scans to be rebuilt: {}", found.error().message);
  if (!*found || !storage_.blobs.availability().ok() ||
      !world_.places.check_for_newcomer({}).ok() || !world_.room.check_disk().ok())
    return;
  ScanRow row = **found;
  row.phase = ScanPhase::kRunning;
  if (const Status begun = storage_.store.scans.update(row); !begun.ok())
    return spdlog::warn("scan {}: {}", row.id, begun.error().message);
  spdlog::info("scan {}: there is room again, its results are made from its frames", row.id);
  rebuilding_ = row.id;
  world_.shown.forget(row.id);
  go_on_with(row, {});
}

void LeftScans::ended(const ScanRow& row) {
  const bool again = rebuilding_ == row.id;
  if (again) rebuilding_.clear();
  if (!again && !row.to_be_rebuilt) return;
  rebuild_pause_ = again && row.to_be_rebuilt ? std::min(2 * rebuild_pause_, kLongestRebuildPause)
                                              : kFirstRebuildPause;
  rebuild_at_ = std::chrono::steady_clock::now() + rebuild_pause_;
}

}  // namespace hermite::server
