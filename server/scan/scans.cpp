#include "server/scan/scans.h"

#include <malloc.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "core/digest/sha256.h"
#include "proto/wire/client_message.h"
#include "proto/wire/frame_payload.h"
#include "server/operations/logging.h"
#include "server/store/scan_id.h"
#include "server/store/unix_time.h"

namespace hermite {

namespace {

constexpr std::size_t kLiveQueueFrames = 4;  // older frames of a live scan are dropped
// How often waiting cameras get a message: they give up when they hear nothing for longer.
constexpr std::chrono::seconds kWaitingPeriod(5);

constexpr std::chrono::hours kOldLogsPeriod(1);
// Even many scans of 5 MB/s each use far less meanwhile than the room needed to start one (scans_disk.cpp).
constexpr std::chrono::seconds kRoomPeriod(1);

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

Scans::Scans(ScansOptions options, const Storage& storage, Metrics& metrics, const LogReaders::Threads& threads)
    : options_(std::move(options)),
      storage_(storage),
      data_(storage.data),
      store_(storage.store),
      metrics_(metrics),
      blobs_(storage.blobs),
      post_(threads.network),
      background_(threads.background),
      places_(options_.places),
      logs_(threads,
            [this](std::size_t reading_count) {
              return running_.size() + reading_count < static_cast<std::size_t>(options_.places.max_running);
            }),
      shown_(blobs_, threads, [this](const std::string& scan_id) { return find(scan_id); }),
      unstored_ends_("scan", "that it has ended", [this](const ScanRow& row) { return store_.scans.update(row); }),
      unstored_removals_("scan", "that it is removed", [this](const ScanRow& row) { return store_.scans.remove(row.id); }) {
  old_logs_removed_at_ = LiveScan::Clock::now() - kOldLogsPeriod;  // due at the first tick
  const Result<std::vector<ScanRow>> left = store_.scans.running();
  if (!left.ok()) throw SetupError(left.error());
  for (const ScanRow& row : *left) {
    if (remove_refused(row)) continue;
    read_log(row, place_of_left(row), [this](LeftScan scan) {
      const ScanRow left_row = scan.launch.row;
      if (const Status status = run_left(std::move(scan)); !status.ok()) interrupt_left(left_row, status.error());
    });
  }
}

PlaceRequest place_request_of(const Grant& grant, wire::Mode mode) {
  return {grant.token_id, may(grant, Scope::kAdmin), mode == wire::Mode::kLive};
}

template <class Tell>
void Scans::deliver(const Launch& launch, Tell tell) const {
  post_([self = launch.self, tell = std::move(tell)]() mutable {
    // Weak: a pending event must not keep a scan or its worker alive.
    if (const std::shared_ptr<LiveScan> target = self->lock()) tell(*target);
  });
}

ScanEvents Scans::worker_events(const Launch& launch, const ScanPast& past) {
  ScanEvents events;
  events.restored = [this, launch, frames = past.received - past.refused](RestoredScan restored) {
    const std::uint64_t replayed = frames - restored.processed - restored.dropped;
    metrics_.scan_rebuilt(restored.processed, replayed);
    deliver(launch, [id = launch.row.id, replayed, restored = std::move(restored)](LiveScan& target) mutable {
      if (!restored.why_not.empty()) spdlog::warn("scan {}: its checkpoint cannot be used: {}", id, restored.why_not);
      spdlog::info("scan {} is rebuilt: {} frames from a checkpoint, {} by replay", id, restored.processed, replayed);
      target.restored(std::move(restored));
    });
  };
  events.frame_done = [this, launch](FrameOutcome outcome) {
    const double latency_s = std::chrono::duration<double>(Timeline::Clock::now() - outcome.arrived).count();
    metrics_.frame_done(outcome.stages, latency_s, outcome.bad_images.has_value(), outcome.result.event == wire::MapEvent::kLost);
    deliver(launch, [this, id = launch.row.id, outcome = std::move(outcome)](LiveScan& target) {
      traces_.add(id, outcome.result.sequence, outcome.stages);
      if (outcome.result.event != wire::MapEvent::kRecalibrated) places_.frame_done(outcome.work_ms / 1000);  // not of all frames again
      target.frame_done(outcome);
    });
  };
  events.model_changed = [this, launch](ModelUpdate update) {
    metrics_.stage_done(update.encoding);
    for (const ChunkUpdate& chunk : update.chunks) metrics_.chunks_encoded(chunk.message->size());
    deliver(launch, [this, id = launch.row.id, update = std::move(update)](LiveScan& target) mutable {
      traces_.add(id, target.counts().processed, {update.encoding});
      places_.memory_measured(id, update.gpu_memory_bytes, update.device_memory_bytes);
      target.model_changed(std::move(update));
    });
  };
  events.mesh_changed = [this, launch](MeshUpdate update) {
    if (!update.ended) metrics_.mesh_made(update.work, std::chrono::duration<double>(update.delay).count());
    for (const MeshPiece& piece : update.pieces) metrics_.chunks_encoded(piece.message->size());
    deliver(launch, [this, id = launch.row.id, update = std::move(update)](LiveScan& target) mutable {
      if (!update.ended) traces_.add(id, target.counts().processed, {update.work});
      target.mesh_changed(std::move(update));
    });
  };
  events.says = [this, launch](std::string message) {
    deliver(launch, [message = std::move(message)](LiveScan& target) { target.worker_says(message); });
  };
  events.ended = [this, launch](ScanEnd end) {
    deliver(launch, [end = std::move(end)](LiveScan& target) mutable { target.ended(std::move(end)); });
  };
  return events;
}

FrameLogEvents Scans::log_events(const Launch& launch) const {
  return {[this, launch](std::uint64_t count) { deliver(launch, [count](LiveScan& target) { target.frames_durable(count); }); },
          [this, launch](const Error& error) { deliver(launch, [error](LiveScan& target) { target.log_failed(error); }); }};
}

Result<Scans::Launch> Scans::launch_of(const std::string& scan_id, const wire::StartScan& request, const std::string& resume_token,
                                       const ScanOwner& owner, const PlaceRequest& place) const {
  const std::size_t max_message_bytes = wire::max_frame_message_bytes(request.camera);
  Launch launch;
  launch.place = place;
  launch.record = {resume_token.empty() ? "" : sha256_hex(resume_token), options_.gpu_memory_mb / options_.places.max_running,
                   static_cast<std::uint32_t>(std::clamp<std::size_t>(kMaxQueuedBytes / max_message_bytes, 1, options_.credit_window)),
                   request};
  Result<Options> options = options_of(launch.record);
  if (!options.ok()) return options.error();
  launch.options = *options;
  launch.row.id = scan_id;
  launch.row.title = request.title;
  launch.row.token_id = owner.token_id;
  launch.row.camera = request.camera;
  launch.row.created_at_ms = unix_now_ms();
  return launch;
}

// Creates folder, log and row in this order, so that a listed scan always has a log.
Result<std::shared_ptr<LiveScan>> Scans::begin(const Launch& launch) {
  const ScanRow& row = launch.row;
  if (Status status = data_.create_scan_folder(row.id); !status.ok()) return status.error();
  Result<std::unique_ptr<FrameLog>> log =
      FrameLog::create(data_.log_folder(row.id), format_terms(launch.record), format_start(launch.record), log_events(launch));
  const Status added = log.ok() ? store_.scans.add(row) : Status(log.error());
  if (!added.ok()) {
    if (Status removed = data_.remove_scan_folder(row.id); !removed.ok()) spdlog::error("{}", removed.error().message);
    return added.error();
  }
  std::shared_ptr<LiveScan> scan = run(launch, {*std::move(log), {}});
  log_with({row.id}, spdlog::level::info,
           fmt::format("scan {} started: {}x{}, {}", row.id, row.camera.width, row.camera.height,
                       launch.record.request.mode == wire::Mode::kLive ? "live" : "batch"));
  return scan;
}

Result<StartedScan> Scans::start(const wire::StartScan& request, const Grant& grant, bool resumable) {
  if (stopping_) return Error{ErrorCode::kBusy, "the server is stopping"};
  const PlaceRequest place = place_request_of(grant, request.mode);
  if (Status status = places_.check(place); !status.ok()) return status.error();
  if (unstored_ends_.full() || unstored_removals_.full()) return Error{ErrorCode::kBusy, "the server's database takes no changes"};
  if (Status status = check_disk(); !status.ok()) return status.error();
  const ScanOwner owner{grant.token_id, place.is_admin};
  if (Status status = check_storage(owner, "", {}); !status.ok()) return status.error();
  const std::string resume_token = resumable ? random_hex(kResumeTokenBytes) : "";
  const Result<Launch> launch = launch_of(new_scan_id(), request, resume_token, owner, place);
  if (!launch.ok()) return launch.error();
  Result<std::shared_ptr<LiveScan>> scan = begin(*launch);
  if (!scan.ok()) return scan.error();

  wire::Welcome welcome;
  welcome.scan_id = launch->row.id;
  welcome.max_message_bytes = wire::max_frame_message_bytes(request.camera);
  welcome.frame_credit = launch->record.credit_window;
  welcome.depth_codec = request.depth_codecs.front();
  welcome.camera = request.camera;
  welcome.title = request.title;
  welcome.resume_token = resume_token;
  welcome.frame_patience_s = static_cast<std::uint32_t>(frame_patience_of(request).count() / 1000);
  if (resumable) welcome.resume_window_s = static_cast<std::uint32_t>(options_.resume_window.count() / 1000);
  return StartedScan{*std::move(scan), std::move(welcome)};
}

// A camera may request a smaller limit than the server's, not a larger one.
std::chrono::milliseconds Scans::frame_patience_of(const wire::StartScan& request) const {
  const std::chrono::milliseconds asked = std::chrono::seconds(request.frame_patience_s);
  return asked.count() == 0 ? options_.frame_patience : std::min(asked, options_.frame_patience);
}

std::shared_ptr<LiveScan> Scans::run(const Launch& launch, FrameLog::Opened opened) {
  const ScanRow& row = launch.row;
  const wire::StartScan& request = launch.record.request;
  ScanPast past{opened.contents.frame_count, opened.contents.refused_count, std::nullopt, opened.contents.finished};
  if (const auto last = wire::parse_client_message(opened.contents.last_frame, kMaxRecordBytes); last.ok())
    if (const wire::Frame* frame = std::get_if<wire::Frame>(&*last)) past.last_timestamp_s = frame->timestamp_s;
  const bool live = request.mode == wire::Mode::kLive;
  const std::uint32_t window = launch.record.credit_window;
  auto subscribers = std::make_shared<Subscribers>(SceneInfo{row.id, row.title, row.camera});
  auto scan = std::make_shared<LiveScan>(ScanTerms{request.mode, window, launch.record.resume_token_sha256, options_.resume_window,
                                                   frame_patience_of(request), request.expected_frames},
                                         past, subscribers, [this, row](const ScanEnd& end) { ended(row, end); });
  *launch.self = scan;
  running_[row.id] = scan;
  unstored_ends_.forget(row.id);
  unstored_removals_.forget(row.id);  // of an earlier attempt of the same job
  ScanSetup setup{options_.device,
                  request.camera,
                  launch.options,
                  request.depth_codecs.front(),
                  live ? std::min<std::size_t>(window, kLiveQueueFrames) : window,
                  row.id,
                  &blobs_,
                  live ? CorrectionTime::kWhenReady : CorrectionTime::kByFrames,
                  data_.log_folder(row.id),
                  opened.contents.record_count,
                  opened.contents.frame_count,
                  options_.checkpoint_period};
  places_.began(row.id, launch.place);
  scan->start(std::make_unique<ScanWorker>(std::move(setup), worker_events(launch, past)), std::move(opened.log));
  return scan;
}

Result<std::optional<ResumedScan>> Scans::resume(const wire::ResumeScan& request) {
  if (stopping_) return Error{ErrorCode::kBusy, "the server is stopping"};
  if (logs_.is_waited_for(request.scan_id)) return Error{ErrorCode::kBusy, "the frame log of the scan is still being read"};
  const auto running = running_.find(request.scan_id);
  if (running == running_.end()) {
    if (const Result<ScanRow> row = find(request.scan_id); !row.ok()) return row.error();
    return std::optional<ResumedScan>();
  }
  const std::shared_ptr<LiveScan> scan = running->second;
  if (Status status = check_resume_token(request.resume_token, scan->resume_token_sha256()); !status.ok()) return status.error();
  const Result<wire::Resumed> resumed = scan->resume(request.next_sequence);
  if (!resumed.ok()) return resumed.error();
  return std::optional(ResumedScan{scan, *resumed, wire::max_frame_message_bytes(scan->subscribers().info().camera)});
}

void Scans::ended(const ScanRow& started, const ScanEnd& end) {
  ScanRow row = as_it_is(started);
  const auto running = running_.find(row.id);
  // Destroyed later, since the scan itself calls this. Then memory in malloc arenas of ended threads is returned to the system.
  post_([this, scan = running->second] {
    background_([] {
#ifdef __GLIBC__
      malloc_trim(0);
#endif
    });
  });
  places_.ended(row.id);
  post_([this] {
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
  if (!end.discarded) (void)unstored_ends_.make(row);
  rebuild_ended(row);
  log_with({row.id, {}, static_cast<double>(row.finished_at_ms - row.created_at_ms) / 1000}, spdlog::level::info,
           fmt::format("scan {} {}: {} frames received, {} processed, {} dropped{}{}", row.id, name_of(row.phase), row.frames_received,
                       row.frames_processed, row.frames_dropped, row.message.empty() ? "" : "; ", row.message));
  metrics_.scan_ended(name_of(row.phase));
  storage_.quota.files_changed();
  device_failed_ = end.phase == wire::ScanPhase::kFailed && end.error.code == ErrorCode::kDevice;
  const FrameCounts& counts = running->second->counts();
  ended_counts_.received += counts.received;
  ended_counts_.processed += counts.processed;
  ended_counts_.dropped += counts.dropped;
  shown_.keep(row.id, running->second->shared_subscribers());
  running_.erase(running);
  if (!end.discarded && row.phase == ScanPhase::kFinished && finished_) finished_(row);
  if (end.discarded) remove_unwanted(row.id);
}

// A row of the store, completed with what only this object knows.
ScanRow Scans::as_it_is(ScanRow row) const {
  const auto running = running_.find(row.id);
  if (running == running_.end()) {
    const ScanRow* const unstored = unstored_ends_.find(row.id);
    return unstored ? *unstored : row;
  }
  const FrameCounts& counts = running->second->counts();
  row.frames_received = static_cast<std::int64_t>(counts.received);
  row.frames_processed = static_cast<std::int64_t>(counts.processed);
  row.frames_dropped = static_cast<std::int64_t>(counts.dropped);
  return row;
}

Result<std::vector<ScanRow>> Scans::list(const std::string& older_than_id) {
  Result<std::vector<ScanRow>> rows = older_than_id.empty() ? store_.scans.list() : store_.scans.list_older_than(older_than_id);
  if (!rows.ok()) return rows;
  std::erase_if(*rows, [this](const ScanRow& row) { return unstored_removals_.find(row.id); });
  for (ScanRow& row : *rows) row = as_it_is(std::move(row));
  return rows;
}

Result<ScanRow> Scans::find(const std::string& scan_id) {
  if (!is_scan_id(scan_id)) return Error{ErrorCode::kNotFound, "there is no such scan: an id has 26 characters of a-z and 0-9"};
  Result<ScanRow> row = store_.scans.find(scan_id);
  if (!row.ok()) return row;
  if (unstored_removals_.find(scan_id)) return Error{ErrorCode::kNotFound, "scan " + scan_id + " is removed"};
  return as_it_is(*std::move(row));
}

std::vector<double> Scans::remaining_s() const {
  const double frame_s = places_.frame_s() * static_cast<double>(running_.size());
  std::vector<double> remaining;
  for (const auto& [id, scan] : running_) {
    const std::optional<std::uint64_t> frames = scan->remaining_frames();
    remaining.push_back(frames ? static_cast<double>(*frames) * frame_s : std::numeric_limits<double>::infinity());
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
    rebuild_next(now);
  }
  unstored_ends_.tick(now);
  unstored_removals_.tick(now);
  if (now - room_watched_at_ >= kRoomPeriod) {
    room_watched_at_ = now;
    watch_room();
  }
  if (now - old_logs_removed_at_ >= kOldLogsPeriod) remove_old_logs(retention_now_ms);
}

void Scans::describe(Load& load) const {
  load.scans = {{"live", 0}, {"batch", 0}};
  FrameCounts counts = ended_counts_;
  for (const auto& [id, scan] : running_) {
    ++load.scans[scan->mode() == wire::Mode::kLive ? "live" : "batch"];
    load.viewers += static_cast<int>(scan->subscribers().viewer_count());
    counts.received += scan->counts().received;
    counts.processed += scan->counts().processed;
    counts.dropped += scan->counts().dropped;
    load.credits += scan->credit();
    load.queue_bytes += scan->queue_bytes();
    load.gpu_memory_bytes += scan->gpu_memory_bytes();
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

}  // namespace hermite
