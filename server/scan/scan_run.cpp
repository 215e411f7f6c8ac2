#include "server/scan/scan_run.h"

#include <spdlog/spdlog.h>

#include <iterator>
#include <new>
#include <utility>

#include "core/base/step_back.h"
#include "core/run/back_end.h"
#include "core/run/results.h"
#include "proto/wire/frame_payload.h"
#include "server/scan/pipeline_messages.h"
#include "server/store/chunk_file.h"

namespace hermite::server {

namespace {

constexpr std::chrono::milliseconds kUpdatePeriod(kMsPerUpdate);
// When no frames arrive, viewers get an encoded update within this time.
constexpr std::chrono::milliseconds kEncodingPatience(20);

// How long a live scan may stop to process past frames again: the frames of that time are dropped.
constexpr double kLongestPause_ms = 10'000;

// The log is synced ten times a second: a disk that takes this long is failing.
constexpr std::chrono::seconds kLogPatience(10);

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

// Finds frames of a log by timestamp, in ascending order; frames in between were dropped.
pipeline::PastFrames frames_by_time(const ScanSetup& setup, std::uint64_t record_count) {
  const auto log = std::make_shared<Replay>(setup.log_folder, record_count);
  return [log, codec = setup.depth_codec, camera = setup.camera](
             std::int64_t, double timestamp_s) -> Result<frame::RgbdFrame> {
    for (;;) {
      const Result<std::optional<wire::Frame>> frame = log->next();
      if (!frame.ok()) return frame.error();
      if (!*frame) return Error{ErrorCode::kNotFound, "the frame log does not have the frame"};
      if ((*frame)->timestamp_s >= timestamp_s)
        return wire::decode_frame_payload(**frame, codec, camera);
    }
  };
}

}  // namespace

ScanRun::ScanRun(const ScanSetup& setup, const ScanEvents& events, FrameQueue& queue,
                 DurableFrames& durable, const std::atomic<bool>& wants_mesh)
    : setup_(setup),
      events_(events),
      queue_(queue),
      durable_(durable),
      wants_mesh_(wants_mesh),
      mesh_(events.mesh_changed),
      chunks_(pipeline::least_output_confidence(setup.options)),
      checkpoints_(*setup.blobs, setup.scan_id, setup.checkpoint_period, durable) {
  begin();
}

void ScanRun::go_on() {
  if (setup_.replayed_record_count == 0) return;
  Result<RestoredScan> restored = restore();
  if (restored.ok()) return events_.restored(*std::move(restored));
  RestoredScan nothing;
  if (restored.error().code != ErrorCode::kNotFound) nothing.why_not = restored.error().message;
  events_.restored(std::move(nothing));
}

Status ScanRun::take_frames() {
  DecodingFrame next;
  for (;;) {
    if (!next) {
      Result<FrameQueue::Popped> popped =
          pop(chunks_.is_busy() ? kEncodingPatience : kUpdatePeriod);
      if (!popped.ok()) return popped.error();
      if (popped->closed) return Done{};
      if (popped->frame) next = decode(*std::move(popped));
    }
    if (next) {
      Result<DecodingFrame> waiting = decode_waiting();
      if (!waiting.ok()) return waiting.error();
      const DecodingFrame now = std::exchange(next, *std::move(waiting));
      if (Status status = take_frame(*now); !status.ok()) return status;
      if (checkpoints_.is_due(Clock::now()))
        if (Status status = write_checkpoint(); !status.ok()) return status;
    }
    if (mesh_.is_due(wants_mesh_, Clock::now()))
      if (Status status = take_changes(); !status.ok()) return status;
    if (Status status = tell_viewers_if_encoded(); !status.ok()) return status;
    if (frames_since_update_ >= kFramesPerUpdate ||
        (frames_since_update_ > 0 && Clock::now() - updated_at_ >= kUpdatePeriod)) {
      if (Status status = start_update(); !status.ok()) return status;
    }
  }
}

Result<wire::Finished> ScanRun::write() {
  const std::string correction_before = pipeline_->statistics().camera_correction;
  mesh_.end();
  pipeline_->finish();
  if (Status status = start_update(); !status.ok()) return status.error();
  is_past_new_ = pipeline_->statistics().camera_correction != correction_before;
  if (Status status = tell_viewers(); !status.ok()) return status.error();
  Result<run::RunResults> results = run::results_of(*pipeline_, setup_.options, {});
  if (!results.ok()) return results.error();
  for (const auto& [name, bytes] : run::files_of(*results))
    if (Status status = put(name, bytes); !status.ok()) return status.error();
  StoredChunks stored;
  for (const pipeline::SubmapPose& pose : pipeline_->submap_poses())
    stored.submaps.push_back({pose.submap, pose.world_from_submap});
  Result<std::vector<output::EncodedChunk>> chunks = chunks_.all();
  if (!chunks.ok()) return chunks.error();
  stored.chunks = *std::move(chunks);
  if (Status status = put(kChunksName, format_chunk_file(stored)); !status.ok())
    return status.error();
  return wire::Finished{std::move(results->report_json), std::move(results->trajectory_text)};
}

void ScanRun::leave() {
  if (checkpoints_.is_on() && record_count_ > saved_record_count_)
    if (const Status status = write_checkpoint(); !status.ok())
      spdlog::warn("scan {}: {}", setup_.scan_id, status.error().message);
  checkpoints_.wait();
}

void ScanRun::begin() {
  replay_.emplace(setup_.log_folder, setup_.replayed_record_count);
  pipeline_.reset();  // frees its memory first
  pipeline::BackEnd back_end = run::make_back_end(setup_.options, setup_.correction_time);
  if (!setup_.log_folder.empty()) back_end.past_frames = [this] { return past_frames(); };
  pipeline_ = std::make_unique<pipeline::Pipeline>(setup_.device, setup_.camera, setup_.options,
                                                   std::move(back_end), &timeline_);
}

pipeline::PastFrames ScanRun::past_frames() {
  const pipeline::PipelineStatistics so_far = pipeline_->statistics();
  if (setup_.correction_time == adjust::CorrectionTime::kWhenReady &&
      so_far.mean_frame_ms * static_cast<double>(so_far.frame_count) > kLongestPause_ms) {
    spdlog::info(
        "scan {}: its camera is off, and {} frames are too many to be worked through again live",
        setup_.scan_id, so_far.frame_count);
    return nullptr;
  }
  if (!durable_.wait_for(taken_count_, kLogPatience)) {
    spdlog::warn("scan {}: its camera cannot be corrected, since its frames are not on disk yet",
                 setup_.scan_id);
    return nullptr;
  }
  events_.says(
      "the camera's calibration is off: the scan is processed again with a better one, hold the "
      "camera still");
  return frames_by_time(setup_, taken_count_ + kRecordsBeforeFrames);
}

Result<RestoredScan> ScanRun::restore() try {
  const Result<ScanCheckpoint> checkpoint =
      read_checkpoint(*setup_.blobs, setup_.scan_id, setup_.replayed_record_count);
  if (!checkpoint.ok()) return checkpoint.error();
  Result<RestoredScan> restored = take(*checkpoint);
  if (!restored.ok()) begin();
  return restored;
} catch (const std::bad_alloc&) {
  begin();
  return Error{ErrorCode::kTooLarge, "there is no memory for the checkpoint"};
}

Result<RestoredScan> ScanRun::take(const ScanCheckpoint& checkpoint) {
  if (Status status = pipeline_->restore(checkpoint.pipeline); !status.ok()) return status.error();
  const Result<std::uint64_t> refused_count = replay_->skip(checkpoint.record_count);
  if (!refused_count.ok()) return refused_count.error();
  RestoredScan restored;
  restored.processed = pipeline_->trajectory().size();
  const std::uint64_t others = restored.processed + *refused_count + kRecordsBeforeFrames;
  if (checkpoint.record_count < others)
    return Error{ErrorCode::kCorruptData,
                 "the checkpoint has more frames than its part of the log"};
  restored.dropped = checkpoint.record_count - others;
  restored.past = wire_past(*pipeline_);
  restored.poses = told_poses_ = wire_poses(*pipeline_);
  last_tracked_ = checkpoint.last_tracked;
  record_count_ = saved_record_count_ = checkpoint.record_count;
  taken_count_ = checkpoint.record_count - kRecordsBeforeFrames;
  // Viewers of this server have received nothing yet.
  pipeline_->forget_taken_changes();
  frames_since_update_ = kFramesPerUpdate;
  return restored;
}

Status ScanRun::write_checkpoint() try {
  const Clock::time_point began = Clock::now();
  Result<std::string> state = pipeline_->save();
  if (!state.ok()) return state.error();
  checkpoints_.write({setup_.scan_id, record_count_, last_tracked_, *std::move(state)}, began);
  saved_record_count_ = record_count_;
  return Done{};
} catch (const std::bad_alloc&) {
  spdlog::warn("scan {}: there is no memory for a checkpoint", setup_.scan_id);
  return Done{};
}

ScanRun::DecodingFrame ScanRun::decode(FrameQueue::Popped popped) const {
  auto decoding = std::make_unique<Decoding>();
  decoding->frame = *std::move(popped.frame);
  decoding->queued = {"queue", popped.since, ms_since(popped.since)};
  decoding->images = std::async(
      std::launch::async, [this, &received = decoding->frame, &stage = decoding->decoded] {
        step_back();
        stage = {"decode", Clock::now(), 0};
        Result<frame::RgbdFrame> images =
            wire::decode_frame_payload(received, setup_.depth_codec, setup_.camera);
        Result<frame::PreparedFrame> prepared =
            images.ok() ? pipeline_->prepare(*std::move(images)) : images.error();
        stage.duration_ms = ms_since(stage.start);
        return prepared;
      });
  return decoding;
}

Result<ScanRun::DecodingFrame> ScanRun::decode_waiting() {
  Result<FrameQueue::Popped> popped = pop(std::chrono::milliseconds(0));
  if (!popped.ok()) return popped.error();
  return popped->frame ? decode(*std::move(popped)) : nullptr;
}

Result<FrameQueue::Popped> ScanRun::pop(std::chrono::milliseconds patience) {
  if (queue_.discarded()) return FrameQueue::Popped{std::nullopt, true};
  Result<std::optional<wire::Frame>> logged = replay_->next();
  if (!logged.ok()) return logged.error();
  if (*logged) return FrameQueue::Popped{**std::move(logged), false, Clock::now()};
  return queue_.pop(patience);
}

Status ScanRun::take_frame(Decoding& decoding) {
  const Clock::time_point start = Clock::now();
  FrameOutcome outcome;
  const wire::Frame& frame = decoding.frame;
  taken_count_ = frame.sequence + 1;
  mesh_.frame_taken(decoding.queued.start);
  Result<frame::PreparedFrame> prepared = decoding.images.get();
  if (!prepared.ok()) outcome.bad_images = prepared.error();
  // A frame that cannot be read is processed as an empty one, as in `hermite reconstruct`, so that
  // every frame has a pose.
  Result<pipeline::FrameResult> result =
      prepared.ok() ? pipeline_->process(*prepared)
                    : pipeline_->process(wire::empty_frame(frame.timestamp_s, setup_.camera));
  if (!result.ok()) return result.error();
  outcome.result = wire_result(*result, frame.sequence, ms_since(start));
  if (result->last_tracked_frame == result->frame_index)
    last_tracked_ = {frame.sequence, result->last_tracked_timestamp_s};
  outcome.result.last_tracked = last_tracked_;
  wire::SubmapPoses poses = wire_poses(*pipeline_);
  outcome.arrived = decoding.queued.start;
  outcome.work_ms = decoding.decoded.duration_ms;
  for (const Timeline::Stage& stage : timeline_.stages) outcome.work_ms += stage.duration_ms;
  outcome.stages = {std::move(decoding.queued), std::move(decoding.decoded)};
  std::move(timeline_.stages.begin(), timeline_.stages.end(), std::back_inserter(outcome.stages));
  timeline_ = {};
  if (!same_poses(poses, told_poses_)) outcome.poses = told_poses_ = std::move(poses);
  if (result->event == pipeline::MapEvent::kRecalibrated) {
    outcome.past = wire_past(*pipeline_);
    outcome.past->pop_back();  // without the current frame
    events_.says("");
  }
  events_.frame_done(std::move(outcome));
  ++frames_since_update_;
  record_count_ = frame.sequence + 1 + kRecordsBeforeFrames;
  return Done{};
}

Status ScanRun::start_update() {
  if (Status status = tell_viewers(); !status.ok()) return status;
  if (Status status = take_changes(); !status.ok()) return status;
  chunks_.start(std::exchange(changes_, {}));
  frames_since_update_ = 0;
  updated_at_ = Clock::now();
  return Done{};
}

Status ScanRun::take_changes() {
  Result<std::vector<output::SlotChange>> changes = mesh_.take_changes(*pipeline_, wants_mesh_);
  if (!changes.ok()) return changes.error();
  std::move(changes->begin(), changes->end(), std::back_inserter(changes_));
  return Done{};
}

Status ScanRun::tell_viewers() {
  if (!chunks_.is_busy()) return Done{};
  Result<ModelUpdate> update = chunks_.take();
  if (!update.ok()) return update.error();
  // The present poses: viewers may already have newer ones than at the start of the encoding.
  update->poses = told_poses_ = wire_poses(*pipeline_);
  if (std::exchange(is_past_new_, false)) update->past = wire_past(*pipeline_);
  measure(pipeline_->statistics(), *update);
  events_.model_changed(*std::move(update));
  return Done{};
}

Status ScanRun::tell_viewers_if_encoded() { return chunks_.is_done() ? tell_viewers() : Done{}; }

std::string ScanRun::last_remark() const { return remark_about_map(pipeline_->statistics()); }

Status ScanRun::put(const char* name, const std::string& bytes) const {
  const Status status = setup_.blobs->put(setup_.scan_id, name, bytes);
  return status.ok() ? status : in_context(std::string("writing ") + name, status.error());
}

}  // namespace hermite::server
