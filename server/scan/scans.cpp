#include "server/scan/scans.h"

#include <fmt/core.h>
#include <malloc.h>
#include <spdlog/spdlog.h>

#include <limits>
#include <utility>

#include "core/base/check.h"
#include "proto/wire/frame_payload.h"
#include "server/operations/logging.h"
#include "server/store/scan_id.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

// How often waiting cameras get a message: they give up when they hear nothing for longer.
constexpr std::chrono::seconds kWaitingPeriod(5);

ScanPhase stored_phase(wire::ScanPhase phase) {
  switch (phase) {
    case wire::ScanPhase::kRunning: return ScanPhase::kRunning;
    case wire::ScanPhase::kFinished: return ScanPhase::kFinished;
    case wire::ScanPhase::kFailed: return ScanPhase::kFailed;
    case wire::ScanPhase::kInterrupted: return ScanPhase::kInterrupted;
  }
  return ScanPhase::kFailed;
}

}  // namespace

Scans::Scans(ScansOptions options, const Storage& storage, Metrics& metrics,
             const LogReaders::Threads& threads)
    : options_(std::move(options)),
      storage_(storage),
      metrics_(metrics),
      threads_(threads),
      launcher_(options_, storage,
                {places_, rows_, running_, metrics, threads.network,
                 [this](const ScanRow& row, const ScanEnd& end) { ended(row, end); }}),
      rows_(storage.store, running_),
      places_(options_.places),
      logs_(threads,
            [this](std::size_t reading_count) {
              return running_.size() + reading_count <
                     static_cast<std::size_t>(options_.places.max_running);
            }),
      room_(options_.min_free_disk_bytes, storage, places_, rows_, running_),
      shown_(storage.blobs, threads,
             [this](const std::string& scan_id) { return rows_.find(scan_id); }),
      ended_(storage, rows_, running_, threads, options_.keep_log_days),
      left_(storage, {launcher_, rows_, room_, places_, logs_, shown_}) {
  left_.go_on_with_all();
}

PlaceRequest place_request_of(const Grant& grant, wire::Mode mode) {
  return {grant.token_id, may(grant, Scope::kAdmin), mode == wire::Mode::kLive};
}

Result<StartedScan> Scans::start(const wire::StartScan& request, const Grant& grant,
                                 bool resumable) {
  if (stopping_) return Error{ErrorCode::kBusy, "the server is stopping"};
  const PlaceRequest place = place_request_of(grant, request.mode);
  if (Status status = places_.check(place); !status.ok()) return status.error();
  if (!rows_.has_room()) return Error{ErrorCode::kBusy, "the server's database takes no changes"};
  if (Status status = room_.check_disk(); !status.ok()) return status.error();
  const ScanOwner owner{grant.token_id, place.is_admin};
  if (Status status = room_.check_storage(owner); !status.ok()) return status.error();
  const std::string resume_token = resumable ? random_hex(kResumeTokenBytes) : "";
  const Result<Launch> launch =
      launcher_.launch_of(new_scan_id(), request, resume_token, owner, place);
  if (!launch.ok()) return launch.error();
  Result<std::shared_ptr<LiveScan>> scan = launcher_.begin(*launch);
  if (!scan.ok()) return scan.error();

  wire::Welcome welcome;
  welcome.scan_id = launch->row.id;
  welcome.max_message_bytes = wire::max_frame_message_bytes(request.camera);
  welcome.frame_credit = launch->record.credit_window;
  welcome.depth_codec = request.depth_codecs.front();
  welcome.camera = request.camera;
  welcome.title = request.title;
  welcome.resume_token = resume_token;
  welcome.frame_patience_s =
      static_cast<std::uint32_t>(launcher_.frame_patience_of(request).count() / 1000);
  if (resumable)
    welcome.resume_window_s = static_cast<std::uint32_t>(options_.resume_window.count() / 1000);
  return StartedScan{*std::move(scan), std::move(welcome)};
}

Result<std::optional<ResumedScan>> Scans::resume(const wire::ResumeScan& request) {
  if (stopping_) return Error{ErrorCode::kBusy, "the server is stopping"};
  if (logs_.is_waited_for(request.scan_id))
    return Error{ErrorCode::kBusy, "the frame log of the scan is still being read"};
  const auto running = running_.find(request.scan_id);
  if (running == running_.end()) {
    if (const Result<ScanRow> row = rows_.find(request.scan_id); !row.ok()) return row.error();
    return std::optional<ResumedScan>();
  }
  const std::shared_ptr<LiveScan> scan = running->second;
  if (Status status = check_resume_token(request.resume_token, scan->terms().resume_token_sha256);
      !status.ok())
    return status.error();
  const Result<wire::Resumed> resumed = scan->resume(request.next_sequence);
  if (!resumed.ok()) return resumed.error();
  return std::optional(ResumedScan{
      scan, *resumed, wire::max_frame_message_bytes(scan->subscribers()->info().camera)});
}

// There is room only after waiting cameras, and not when it would slow down a live scan. A scan
// left by an earlier server has its place already.
bool Scans::has_room_for(const std::string& scan_id) const {
  if (stopping_) return false;
  return left_.has(scan_id) || (places_.check_for_newcomer({}).ok() && room_.check_disk().ok());
}

Result<std::optional<JobScan>> Scans::run_for_job(const std::string& scan_id,
                                                  const std::string& upload_id,
                                                  const ScanOwner& owner,
                                                  const wire::StartScan& request) {
  CHECK(has_room_for(scan_id), "a job waits for room");
  if (logs_.is_waited_for(scan_id)) return std::optional<JobScan>();
  if (Status status = room_.check_storage(owner, upload_id); !status.ok()) return status.error();
  const Result<ScanRow> row = storage_.store.scans.find(scan_id);
  if (!left_.is_read(scan_id) && row.ok() && row->phase == ScanPhase::kRunning) {
    left_.read_for_job(*row);
    return std::optional<JobScan>();
  }
  if (!left_.run_for_job(scan_id)) {
    // Remains of a start that only created its folder, or of a scan that failed with the server.
    places_.ended(scan_id);
    if (Status status = remove_files_of_scan(storage_, scan_id); !status.ok())
      return status.error();
    if (row.ok())
      if (Status status = storage_.store.scans.remove(scan_id); !status.ok()) return status.error();
    // Nobody knows this token; it only makes the scan resumable, so that it stays running for the
    // next server.
    const Result<Launch> launch =
        launcher_.launch_of(scan_id, request, random_hex(kResumeTokenBytes), owner, {});
    if (!launch.ok()) return launch.error();
    if (const Result<std::shared_ptr<LiveScan>> scan = launcher_.begin(*launch); !scan.ok())
      return scan.error();
  }
  const std::shared_ptr<LiveScan> scan = running_.at(scan_id);
  const Result<wire::Resumed> resumed = scan->resume(0);
  if (!resumed.ok()) return resumed.error();
  return std::optional(JobScan{scan, resumed->next_sequence, resumed->frames_granted,
                               wire::max_frame_message_bytes(request.camera)});
}

Status Scans::add_imported(const ScanRow& row, bool may_be_meshed) {
  if (Status added = storage_.store.scans.add(row); !added.ok()) return added;
  rows_.begin_again(row.id);  // of an earlier attempt of the same job
  log_with({row.id}, spdlog::level::info,
           fmt::format("scan {} added, with all of its files", row.id));
  metrics_.scan_ended(name_of(row.phase));
  storage_.quota.files_changed();
  if (may_be_meshed && finished_) finished_(row);
  return Done{};
}

void Scans::remove_unwanted(const std::string& scan_id) {
  CHECK(!running_.contains(scan_id), "a scan that runs is discarded");
  left_.drop(scan_id);
  if (const Status removed = remove_files_of_scan(storage_, scan_id); !removed.ok())
    spdlog::warn("{}", removed.error().message);
  shown_.forget(scan_id);
  ScanRow row;
  row.id = scan_id;
  (void)rows_.remove(row);
}

Result<std::shared_ptr<Subscribers>> Scans::watch(const std::string& scan_id) {
  if (const auto running = running_.find(scan_id); running != running_.end())
    return running->second->subscribers();
  return shown_.watch(scan_id);
}

Status Scans::remove(const std::string& scan_id) {
  if (running_.contains(scan_id))
    return Error{ErrorCode::kBusy, fmt::format("scan {} is running", scan_id)};
  const Result<ScanRow> row = rows_.find(scan_id);
  if (!row.ok()) return row.error();
  if (row->phase == ScanPhase::kRunning)
    return Error{ErrorCode::kBusy,
                 fmt::format("scan {} is to go on: cancel its job, or try again later", scan_id)};
  if (Status status = remove_files_of_scan(storage_, scan_id); !status.ok()) return status;
  shown_.forget(scan_id);
  return rows_.remove(*row);
}

LiveScan* Scans::running(const std::string& scan_id) const {
  const auto running = running_.find(scan_id);
  return running == running_.end() ? nullptr : running->second.get();
}

Status Scans::label(const std::string& scan_id, const ScanLabels& labels) {
  if (Status labelled = rows_.label(scan_id, labels); !labelled.ok()) return labelled;
  if (!labels.title) return Done{};
  if (const auto running = running_.find(scan_id); running != running_.end())
    running->second->subscribers()->rename(*labels.title);
  shown_.forget(scan_id);
  return Done{};
}

Status Scans::end(const std::string& scan_id) {
  const Result<ScanRow> row = rows_.find(scan_id);
  if (!row.ok()) return row.error();
  const auto running = running_.find(scan_id);
  if (running == running_.end() || !running->second->lifecycle().takes_frames())
    return Error{
        ErrorCode::kBusy,
        fmt::format("scan {} takes no frames any more: there is nothing to stop", scan_id)};
  const Result<std::vector<JobRow>> jobs = storage_.store.jobs.in_state(JobState::kRunning);
  if (!jobs.ok()) return jobs.error();
  for (const JobRow& job : *jobs)
    if (job.scan_id == scan_id)
      return Error{ErrorCode::kBusy,
                   fmt::format("scan {} is made by job {}: cancel that", scan_id, job.id)};
  running->second->end_early({ErrorCode::kBusy, "stopped from the viewer"});
  return Done{};
}

void Scans::ended(const ScanRow& started, const ScanEnd& end) {
  ScanRow row = rows_.as_it_is(started);
  const auto running = running_.find(row.id);
  // Destroyed later, since the scan itself calls this. Then memory in malloc arenas of ended
  // threads is returned to the system.
  threads_.network([this, scan = running->second] {
    threads_.background([] {
#ifdef __GLIBC__
      malloc_trim(0);
#endif
    });
  });
  places_.ended(row.id);
  threads_.network([this] {
    logs_.go_on();
    places_.serve();
  });
  if (end.phase == wire::ScanPhase::kRunning) {
    spdlog::info("scan {} is left running, with {} frames in its log", row.id, row.frames_received);
    running_.erase(running);
    return;
  }
  row.phase = stored_phase(end.phase);
  row.message = end.message;
  row.finished_at_ms = unix_now_ms();
  row.to_be_rebuilt = end.results_missing;
  if (!end.discarded) (void)rows_.end(row);
  left_.ended(row);
  log_with({row.id, {}, static_cast<double>(row.finished_at_ms - row.created_at_ms) / 1000},
           spdlog::level::info,
           fmt::format("scan {} {}: {} frames received, {} processed, {} dropped{}{}", row.id,
                       name_of(row.phase), row.frames_received, row.frames_processed,
                       row.frames_dropped, row.message.empty() ? "" : "; ", row.message));
  metrics_.scan_ended(name_of(row.phase));
  storage_.quota.files_changed();
  device_failed_ = end.phase == wire::ScanPhase::kFailed && end.error.code == ErrorCode::kDevice;
  const FrameCounts& counts = running->second->frames().counts();
  ended_counts_.received += counts.received;
  ended_counts_.processed += counts.processed;
  ended_counts_.dropped += counts.dropped;
  shown_.keep(row.id, running->second->subscribers());
  running_.erase(running);
  if (!end.discarded && row.phase == ScanPhase::kFinished && finished_) finished_(row);
  if (end.discarded) remove_unwanted(row.id);
}

std::vector<double> Scans::remaining_s() const {
  const double frame_s = places_.frame_s() * static_cast<double>(running_.size());
  std::vector<double> remaining;
  for (const auto& [id, scan] : running_) {
    const std::optional<std::uint64_t> frames = scan->frames().remaining_count();
    remaining.push_back(frames ? static_cast<double>(*frames) * frame_s
                               : std::numeric_limits<double>::infinity());
  }
  return remaining;
}

void Scans::tick(LiveScan::Clock::time_point now, std::int64_t retention_now_ms) {
  for (const auto& [id, scan] : running_) scan->tick(now);
  logs_.tick(now);
  storage_.quota.tick(now);
  if (now - told_to_wait_at_ >= kWaitingPeriod) {
    told_to_wait_at_ = now;
    if (places_.waiting_count() > 0) places_.tell(remaining_s());
    if (!stopping_) left_.rebuild_next(now);
  }
  rows_.tick(now);
  room_.tick(now);
  ended_.tick(now, retention_now_ms);
}

void Scans::describe(Load& load) const {
  load.scans = {{"live", 0}, {"batch", 0}};
  FrameCounts counts = ended_counts_;
  for (const auto& [id, scan] : running_) {
    ++load.scans[scan->terms().mode == wire::Mode::kLive ? "live" : "batch"];
    load.viewers += static_cast<int>(scan->subscribers()->viewer_count());
    const FrameCounts& counts_of_scan = scan->frames().counts();
    counts.received += counts_of_scan.received;
    counts.processed += counts_of_scan.processed;
    counts.dropped += counts_of_scan.dropped;
    load.credits += scan->frames().free_window();
    load.queue_bytes += scan->queue_bytes();
    load.gpu_memory_bytes += scan->display().gpu_memory_bytes();
  }
  load.viewers += static_cast<int>(shown_.viewer_count());
  load.waiting_cameras = static_cast<int>(places_.waiting_count());
  load.gpu_memory_limit_bytes = places_.gpu_memory_bytes();
  load.scan_gpu_memory_bytes = places_.scan_gpu_memory_bytes();
  load.frames_received = counts.received;
  load.frames_processed = counts.processed;
  load.frames_dropped = counts.dropped;
}

void Scans::refuse_new() {
  stopping_ = true;
  logs_.stop();
  places_.dismiss();
}

void Scans::stop() {
  refuse_new();
  for (const auto& [id, scan] : running_) scan->stop();
}

}  // namespace hermite::server
