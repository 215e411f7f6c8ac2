#include "server/scan/scan_launcher.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/digest/sha256.h"
#include "proto/wire/client_message.h"
#include "proto/wire/frame_payload.h"
#include "server/operations/logging.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

constexpr std::size_t kLiveQueueFrames = 4;  // older frames of a live scan are dropped

}  // namespace

ScanLauncher::ScanLauncher(const ScansOptions& options, const Storage& storage, World world)
    : options_(options), storage_(storage), world_(std::move(world)) {}

template <class Tell>
void ScanLauncher::deliver(const Launch& launch, Tell tell) const {
  world_.post([self = launch.self, tell = std::move(tell)]() mutable {
    // Weak: a pending event must not keep a scan or its worker alive.
    if (const std::shared_ptr<LiveScan> target = self->lock()) tell(*target);
  });
}

ScanEvents ScanLauncher::worker_events(const Launch& launch, const ScanPast& past) {
  ScanEvents events;
  events.restored = [this, launch, frames = past.received - past.refused](RestoredScan restored) {
    const std::uint64_t replayed = frames - restored.processed - restored.dropped;
    world_.metrics.scan_rebuilt(restored.processed, replayed);
    deliver(launch, [id = launch.row.id, replayed,
                     restored = std::move(restored)](LiveScan& target) mutable {
      if (!restored.why_not.empty())
        spdlog::warn("scan {}: its checkpoint cannot be used: {}", id, restored.why_not);
      spdlog::info("scan {} is rebuilt: {} frames from a checkpoint, {} by replay", id,
                   restored.processed, replayed);
      target.restored(std::move(restored));
    });
  };
  events.frame_done = [this, launch](FrameOutcome outcome) {
    const double latency_s =
        std::chrono::duration<double>(Timeline::Clock::now() - outcome.arrived).count();
    world_.metrics.frame_done(outcome.stages, latency_s, outcome.bad_images.has_value(),
                              outcome.result.event == wire::MapEvent::kLost);
    deliver(launch, [this, id = launch.row.id, outcome = std::move(outcome)](LiveScan& target) {
      traces_.add(id, outcome.result.sequence, outcome.stages);
      if (outcome.result.event != wire::MapEvent::kRecalibrated)
        world_.places.frame_done(outcome.work_ms / 1000);  // not of all frames again
      target.frame_done(outcome);
    });
  };
  events.model_changed = [this, launch](ModelUpdate update) {
    world_.metrics.stage_done(update.encoding);
    for (const ChunkUpdate& chunk : update.chunks)
      world_.metrics.chunks_encoded(chunk.message->size());
    deliver(
        launch, [this, id = launch.row.id, update = std::move(update)](LiveScan& target) mutable {
          traces_.add(id, target.frames().counts().processed, {update.encoding});
          world_.places.memory_measured(id, update.gpu_memory_bytes, update.device_memory_bytes);
          target.display().model_changed(std::move(update));
        });
  };
  events.mesh_changed = [this, launch](MeshUpdate update) {
    if (!update.ended)
      world_.metrics.mesh_made(update.work, std::chrono::duration<double>(update.delay).count());
    for (const MeshPiece& piece : update.pieces)
      world_.metrics.chunks_encoded(piece.message->size());
    deliver(launch,
            [this, id = launch.row.id, update = std::move(update)](LiveScan& target) mutable {
              if (!update.ended) traces_.add(id, target.frames().counts().processed, {update.work});
              target.display().mesh_changed(std::move(update));
            });
  };
  events.says = [this, launch](std::string message) {
    deliver(launch, [message = std::move(message)](LiveScan& target) {
      target.display().worker_says(message);
    });
  };
  events.ended = [this, launch](ScanEnd end) {
    deliver(launch,
            [end = std::move(end)](LiveScan& target) mutable { target.ended(std::move(end)); });
  };
  return events;
}

frame_log::FrameLogEvents ScanLauncher::log_events(const Launch& launch) const {
  return {[this, launch](std::uint64_t count) {
            deliver(launch, [count](LiveScan& target) { target.frames_durable(count); });
          },
          [this, launch](const Error& error) {
            deliver(launch, [error](LiveScan& target) { target.log_failed(error); });
          }};
}

Result<Launch> ScanLauncher::launch_of(const std::string& scan_id, const wire::StartScan& request,
                                       const std::string& resume_token, const ScanOwner& owner,
                                       const PlaceRequest& place) const {
  const std::size_t max_message_bytes = wire::max_frame_message_bytes(request.camera);
  Launch launch;
  launch.place = place;
  launch.record = {resume_token.empty() ? "" : digest::sha256_hex(resume_token),
                   options_.gpu_memory_mb / options_.places.max_running,
                   static_cast<std::uint32_t>(std::clamp<std::size_t>(
                       kMaxQueuedBytes / max_message_bytes, 1, options_.credit_window)),
                   request};
  Result<pipeline::Options> options = options_of(launch.record);
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
Result<std::shared_ptr<LiveScan>> ScanLauncher::begin(const Launch& launch) {
  const ScanRow& row = launch.row;
  if (Status status = storage_.data.create_scan_folder(row.id); !status.ok()) return status.error();
  Result<std::unique_ptr<frame_log::FrameLog>> log =
      frame_log::FrameLog::create(storage_.data.log_folder(row.id), format_terms(launch.record),
                                  format_start(launch.record), log_events(launch));
  const Status added = log.ok() ? storage_.store.scans.add(row) : Status(log.error());
  if (!added.ok()) {
    if (Status removed = storage_.data.remove_scan_folder(row.id); !removed.ok())
      spdlog::error("{}", removed.error().message);
    return added.error();
  }
  std::shared_ptr<LiveScan> scan = run(launch, {*std::move(log), {}});
  log_with({row.id}, spdlog::level::info,
           fmt::format("scan {} started: {}x{}, {}", row.id, row.camera.width, row.camera.height,
                       launch.record.request.mode == wire::Mode::kLive ? "live" : "batch"));
  return scan;
}

std::chrono::milliseconds ScanLauncher::frame_patience_of(const wire::StartScan& request) const {
  const std::chrono::milliseconds asked = std::chrono::seconds(request.frame_patience_s);
  return asked.count() == 0 ? options_.frame_patience : std::min(asked, options_.frame_patience);
}

std::shared_ptr<LiveScan> ScanLauncher::run(const Launch& launch,
                                            frame_log::FrameLog::Opened opened) {
  const ScanRow& row = launch.row;
  const wire::StartScan& request = launch.record.request;
  ScanPast past{opened.contents.frame_count, opened.contents.refused_count, std::nullopt,
                opened.contents.finished};
  if (const auto last =
          wire::parse_client_message(opened.contents.last_frame, frame_log::kMaxRecordBytes);
      last.ok())
    if (const wire::Frame* frame = std::get_if<wire::Frame>(&*last))
      past.last_timestamp_s = frame->timestamp_s;
  const bool live = request.mode == wire::Mode::kLive;
  const std::uint32_t window = launch.record.credit_window;
  auto subscribers = std::make_shared<Subscribers>(SceneInfo{row.id, row.title, row.camera});
  auto scan = std::make_shared<LiveScan>(
      ScanTerms{request.mode, window, launch.record.resume_token_sha256, options_.resume_window,
                frame_patience_of(request), request.expected_frames},
      past, subscribers, [this, row](const ScanEnd& end) { world_.ended(row, end); });
  *launch.self = scan;
  world_.running[row.id] = scan;
  world_.rows.begin_again(row.id);  // after an earlier attempt of the same job
  ScanSetup setup{options_.device,
                  request.camera,
                  launch.options,
                  request.depth_codecs.front(),
                  live ? std::min<std::size_t>(window, kLiveQueueFrames) : window,
                  row.id,
                  &storage_.blobs,
                  live ? adjust::CorrectionTime::kWhenReady : adjust::CorrectionTime::kByFrames,
                  storage_.data.log_folder(row.id),
                  opened.contents.record_count,
                  opened.contents.frame_count,
                  options_.checkpoint_period};
  world_.places.began(row.id, launch.place);
  scan->start(std::make_unique<ScanWorker>(std::move(setup), worker_events(launch, past)),
              std::move(opened.log));
  return scan;
}

}  // namespace hermite::server
