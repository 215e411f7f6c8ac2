#include "server/service/scan_worker.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <iterator>
#include <memory>
#include <mutex>
#include <new>
#include <set>
#include <thread>
#include <utility>

#include "core/base/step_back.h"
#include "core/pipeline/pipeline.h"
#include "core/run/back_end.h"
#include "core/run/results.h"
#include "proto/wire/frame_payload.h"
#include "proto/wire/server_message.h"
#include "server/service/checkpoint_writer.h"
#include "server/service/frame_queue.h"
#include "server/service/live_mesher.h"
#include "server/service/pipeline_words.h"
#include "server/service/replay.h"
#include "server/service/scan_end.h"
#include "server/store/chunk_file.h"

namespace hermite {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kUpdatePeriod(kMsPerUpdate);
// Without frames to wait for, viewers are told within so long after an update is encoded.
constexpr std::chrono::milliseconds kEncodingPatience(20);

// A person who scans holds still for so long, and the frames of that time are not seen.
constexpr double kLongestPause_ms = 10'000;

// The log is synced ten times a second: a disk that takes so much longer has other troubles.
constexpr std::chrono::seconds kLogPatience(10);

double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

// The worker's thread: one scan from the first frame to its files.
class ScanRun {
 public:
  ScanRun(const ScanSetup& setup, const ScanEvents& events, FrameQueue& queue, DurableFrames& durable, const std::atomic<bool>& wants_mesh)
      : setup_(setup),
        events_(events),
        queue_(queue),
        durable_(durable),
        wants_mesh_(wants_mesh),
        mesh_(events.mesh_changed),
        model_(0, least_output_confidence(setup.options)),
        checkpoints_(*setup.blobs, setup.scan_id, setup.checkpoint_period, durable) {
    begin();
  }

  // Where an earlier server was with the scan, as far as there is a checkpoint of it; the rest is worked through again.
  void go_on() {
    if (setup_.replayed_record_count == 0) return;
    Result<RestoredScan> restored = restore();
    if (restored.ok()) return events_.restored(*std::move(restored));
    RestoredScan nothing;
    if (restored.error().code != ErrorCode::kNotFound) nothing.why_not = restored.error().message;
    events_.restored(std::move(nothing));
  }

  // While the GPU works on a frame, other threads decode and prepare the next one and encode what the last ones have changed.
  Status take_frames() {
    DecodingFrame next;
    for (;;) {
      if (!next) {
        Result<FrameQueue::Popped> popped = pop(encoding_.valid() ? kEncodingPatience : kUpdatePeriod);
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
      if (frames_since_update_ >= kFramesPerUpdate || (frames_since_update_ > 0 && Clock::now() - updated_at_ >= kUpdatePeriod)) {
        if (Status status = start_update(); !status.ok()) return status;
      }
    }
  }

  Result<wire::Finished> write() {
    const std::string correction_before = pipeline_->statistics().camera_correction;
    mesh_.end();
    pipeline_->finish();
    if (Status status = start_update(); !status.ok()) return status.error();
    is_past_new_ = pipeline_->statistics().camera_correction != correction_before;
    if (Status status = tell_viewers(); !status.ok()) return status.error();
    Result<RunResults> results = results_of(*pipeline_, setup_.options, {});
    if (!results.ok()) return results.error();
    for (const auto& [name, bytes] : files_of(*results))
      if (Status status = put(name, bytes); !status.ok()) return status.error();
    StoredChunks stored;
    for (const SubmapPose& pose : pipeline_->submap_poses()) stored.submaps.push_back({pose.submap, pose.world_from_submap});
    for (const ChunkKey& key : filled_) {
      Result<EncodedChunk> chunk = model_.encode(key);
      if (!chunk.ok()) return chunk.error();
      stored.chunks.push_back(*std::move(chunk));
    }
    if (Status status = put(kChunksName, format_chunk_file(stored)); !status.ok()) return status.error();
    return wire::Finished{std::move(results->report_json), std::move(results->trajectory_text)};
  }

  // The next server goes on from here. Whatever goes wrong: it has the frame log.
  void leave() {
    if (checkpoints_.is_on() && record_count_ > saved_record_count_)
      if (const Status status = write_checkpoint(); !status.ok()) spdlog::warn("scan {}: {}", setup_.scan_id, status.error().message);
    checkpoints_.wait();
  }

  std::string last_words() const { return words_about_map(pipeline_->statistics()); }

 private:
  struct Decoding {
    wire::Frame frame;
    Timeline::Stage queued;
    Timeline::Stage decoded;                    // written by the other thread
    std::future<Result<PreparedFrame>> images;  // its destructor waits, and the others live longer
  };
  using DecodingFrame = std::unique_ptr<Decoding>;

  void begin() {
    replay_.emplace(setup_.log_folder, setup_.replayed_record_count);
    pipeline_.reset();  // its memory first
    BackEnd back_end = make_back_end(setup_.options, setup_.correction_time);
    if (!setup_.log_folder.empty()) back_end.past_frames = [this] { return past_frames(); };
    pipeline_ = std::make_unique<Pipeline>(setup_.device, setup_.camera, setup_.options, std::move(back_end), &timeline_);
  }

  // All up to the one in work, from the log. None, and the camera stays as it is: they are too many for a live scan, or not there in time.
  PastFrames past_frames() {
    const PipelineStatistics so_far = pipeline_->statistics();
    if (setup_.correction_time == CorrectionTime::kWhenReady &&
        so_far.mean_frame_ms * static_cast<double>(so_far.frame_count) > kLongestPause_ms) {
      spdlog::info("scan {}: its camera is off, and {} frames are too many to be worked through again live", setup_.scan_id,
                   so_far.frame_count);
      return nullptr;
    }
    if (!durable_.wait_for(taken_count_, kLogPatience)) {
      spdlog::warn("scan {}: its camera cannot be corrected, since its frames are not on disk yet", setup_.scan_id);
      return nullptr;
    }
    events_.says("the camera's calibration is off: the scan is worked through again with a better one, hold the camera still");
    const auto log = std::make_shared<Replay>(setup_.log_folder, taken_count_ + kRecordsBeforeFrames);
    return [this, log](std::int64_t, double timestamp_s) -> Result<RgbdFrame> {
      for (;;) {
        const Result<std::optional<wire::Frame>> frame = log->next();
        if (!frame.ok()) return frame.error();
        if (!*frame) return Error{ErrorCode::kNotFound, "the frame log does not have the frame"};
        // Times grow, and frames that were dropped lie between.
        if ((*frame)->timestamp_s >= timestamp_s) return wire::decode_frame_payload(**frame, setup_.depth_codec, setup_.camera);
      }
    };
  }

  // kNotFound: there is no checkpoint. After any error the scan is at its beginning.
  Result<RestoredScan> restore() try {
    const Result<ScanCheckpoint> checkpoint = read_checkpoint(*setup_.blobs, setup_.scan_id, setup_.replayed_record_count);
    if (!checkpoint.ok()) return checkpoint.error();
    Result<RestoredScan> restored = take(*checkpoint);
    if (!restored.ok()) begin();
    return restored;
  } catch (const std::bad_alloc&) {
    begin();
    return Error{ErrorCode::kTooLarge, "there is no memory for the checkpoint"};
  }

  // After an error or a throw it may have been taken in part.
  Result<RestoredScan> take(const ScanCheckpoint& checkpoint) {
    if (Status status = pipeline_->restore(checkpoint.pipeline); !status.ok()) return status.error();
    const Result<std::uint64_t> refused_count = replay_->skip(checkpoint.record_count);
    if (!refused_count.ok()) return refused_count.error();
    RestoredScan restored;
    restored.processed = pipeline_->trajectory().size();
    const std::uint64_t others = restored.processed + *refused_count + kRecordsBeforeFrames;
    if (checkpoint.record_count < others) return Error{ErrorCode::kCorruptData, "the checkpoint has more frames than its part of the log"};
    restored.dropped = checkpoint.record_count - others;
    restored.past = wire_past(*pipeline_);
    restored.poses = told_poses_ = wire_poses(*pipeline_);
    last_tracked_ = checkpoint.last_tracked;
    record_count_ = saved_record_count_ = checkpoint.record_count;
    taken_count_ = checkpoint.record_count - kRecordsBeforeFrames;
    // Viewers are new to this server.
    pipeline_->forget_taken_changes();
    frames_since_update_ = kFramesPerUpdate;
    return restored;
  }

  // Of all frames so far. An error is the device's, with which the scan ends; without memory it goes on without a checkpoint.
  Status write_checkpoint() try {
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

  DecodingFrame decode(FrameQueue::Popped popped) const {
    auto decoding = std::make_unique<Decoding>();
    decoding->frame = *std::move(popped.frame);
    decoding->queued = {"queue", popped.since, ms_since(popped.since)};
    decoding->images = std::async(std::launch::async, [this, &received = decoding->frame, &stage = decoding->decoded] {
      step_back();
      stage = {"decode", Clock::now(), 0};
      Result<RgbdFrame> images = wire::decode_frame_payload(received, setup_.depth_codec, setup_.camera);
      Result<PreparedFrame> prepared = images.ok() ? pipeline_->prepare(*std::move(images)) : images.error();
      stage.duration_ms = ms_since(stage.start);
      return prepared;
    });
    return decoding;
  }

  // The next frame, if it is there already.
  Result<DecodingFrame> decode_waiting() {
    Result<FrameQueue::Popped> popped = pop(std::chrono::milliseconds(0));
    if (!popped.ok()) return popped.error();
    return popped->frame ? decode(*std::move(popped)) : nullptr;
  }

  // From the log, as long as there is something in it to be done again, then from the queue.
  Result<FrameQueue::Popped> pop(std::chrono::milliseconds patience) {
    if (queue_.discarded()) return FrameQueue::Popped{std::nullopt, true};
    Result<std::optional<wire::Frame>> logged = replay_->next();
    if (!logged.ok()) return logged.error();
    if (*logged) return FrameQueue::Popped{**std::move(logged), false, Clock::now()};
    return queue_.pop(patience);
  }

  Status take_frame(Decoding& decoding) {
    const Clock::time_point start = Clock::now();
    FrameOutcome outcome;
    const wire::Frame& frame = decoding.frame;
    taken_count_ = frame.sequence + 1;
    mesh_.frame_taken(decoding.queued.start);
    Result<PreparedFrame> prepared = decoding.images.get();
    if (!prepared.ok()) outcome.bad_images = prepared.error();
    // A frame that cannot be read counts as one that shows nothing, as in `hermite reconstruct`: every frame has its pose.
    Result<FrameResult> result =
        prepared.ok() ? pipeline_->process(*prepared) : pipeline_->process(wire::empty_frame(frame.timestamp_s, setup_.camera));
    if (!result.ok()) return result.error();
    outcome.result = wire_result(*result, frame.sequence, ms_since(start));
    if (result->last_tracked_frame == result->frame_index) last_tracked_ = {frame.sequence, result->last_tracked_timestamp_s};
    outcome.result.last_tracked = last_tracked_;
    wire::SubmapPoses poses = wire_poses(*pipeline_);
    outcome.arrived = decoding.queued.start;
    outcome.work_ms = decoding.decoded.duration_ms;
    for (const Timeline::Stage& stage : timeline_.stages) outcome.work_ms += stage.duration_ms;
    outcome.stages = {std::move(decoding.queued), std::move(decoding.decoded)};
    std::move(timeline_.stages.begin(), timeline_.stages.end(), std::back_inserter(outcome.stages));
    timeline_ = {};
    if (!same_poses(poses, told_poses_)) outcome.poses = told_poses_ = std::move(poses);
    if (result->event == MapEvent::kRecalibrated) {
      outcome.past = wire_past(*pipeline_);
      outcome.past->pop_back();  // this one
      events_.says("");
    }
    events_.frame_done(std::move(outcome));
    ++frames_since_update_;
    record_count_ = frame.sequence + 1 + kRecordsBeforeFrames;
    return Done{};
  }

  // Ends the update before this one: one at a time owns model_, filled_ and version_.
  Status start_update() {
    if (Status status = tell_viewers(); !status.ok()) return status;
    if (Status status = take_changes(); !status.ok()) return status;
    encoding_ = std::async(std::launch::async, [this, changes = std::exchange(changes_, {})] { return encode(changes); });
    frames_since_update_ = 0;
    updated_at_ = Clock::now();
    return Done{};
  }

  // For the surface at once, for the chunks until they are encoded next.
  Status take_changes() {
    Result<std::vector<SlotChange>> changes = mesh_.take_changes(*pipeline_, wants_mesh_);
    if (!changes.ok()) return changes.error();
    std::move(changes->begin(), changes->end(), std::back_inserter(changes_));
    return Done{};
  }

  Result<ModelUpdate> encode(const std::vector<SlotChange>& changes) {
    step_back();
    ModelUpdate update;
    update.encoding = {"encode", Clock::now(), 0};
    model_.apply(changes);
    for (const ChunkKey& key : model_.take_dirty()) {
      Result<EncodedChunk> chunk = model_.encode(key);
      if (!chunk.ok()) return chunk.error();
      const bool empty = chunk->point_count == 0;
      if (empty) filled_.erase(key);
      if (!empty) filled_.insert(key);
      wire::Chunk message{{key.submap, key.level, key.x, key.y, key.z}, ++version_, chunk->point_count, std::move(chunk->draco)};
      update.chunks.push_back({key, empty, std::make_shared<const std::string>(wire::format_server_message(std::move(message)))});
    }
    update.encoding.duration_ms = ms_since(update.encoding.start);
    return update;
  }

  Status tell_viewers() {
    if (!encoding_.valid()) return Done{};
    Result<ModelUpdate> update = encoding_.get();
    if (!update.ok()) return update.error();
    // As they are now: viewers may have been told of newer ones than there were when the encoding began.
    update->poses = told_poses_ = wire_poses(*pipeline_);
    if (std::exchange(is_past_new_, false)) update->past = wire_past(*pipeline_);
    measure(pipeline_->statistics(), *update);
    events_.model_changed(*std::move(update));
    return Done{};
  }

  Status tell_viewers_if_encoded() {
    if (!encoding_.valid() || encoding_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return Done{};
    return tell_viewers();
  }

  Status put(const char* name, const std::string& bytes) const {
    const Status status = setup_.blobs->put(setup_.scan_id, name, bytes);
    return status.ok() ? status : in_context(std::string("writing ") + name, status.error());
  }

  const ScanSetup& setup_;
  const ScanEvents& events_;
  FrameQueue& queue_;
  DurableFrames& durable_;
  const std::atomic<bool>& wants_mesh_;
  MeshFeed mesh_;
  std::uint64_t taken_count_ = 0;  // frames of the log up to the one in work
  std::optional<Replay> replay_;
  Timeline timeline_;  // of the frame in work
  std::unique_ptr<Pipeline> pipeline_;
  std::vector<SlotChange> changes_;  // that are not encoded yet
  ChunkedModel model_;
  std::set<ChunkKey> filled_;  // chunks that have points
  std::uint64_t version_ = 0;  // of the chunks, one count for all
  bool is_past_new_ = false;
  int frames_since_update_ = 0;
  Clock::time_point updated_at_ = Clock::now();
  std::optional<wire::TrackedFrame> last_tracked_;
  wire::SubmapPoses told_poses_;
  std::uint64_t record_count_ = 0, saved_record_count_ = 0;  // of the frame log: that the pipeline has, and the last checkpoint
  CheckpointWriter checkpoints_;
  std::future<Result<ModelUpdate>> encoding_;  // last: its destructor waits for what uses the others
};

}  // namespace

struct ScanWorker::Impl {
  const ScanSetup setup;
  const ScanEvents events;
  FrameQueue queue;
  DurableFrames durable;
  std::mutex mutex;
  std::optional<Error> interrupted;  // guarded by mutex; why the scan ended early
  bool finishing = false;            // guarded by mutex
  std::optional<Abandon> abandoned;  // guarded by mutex
  std::atomic<bool> wants_mesh = false;
  std::thread thread;

  Impl(ScanSetup scan_setup, ScanEvents scan_events)
      : setup(std::move(scan_setup)), events(std::move(scan_events)), queue(setup.queue_capacity), durable(setup.replayed_frame_count) {}

  std::optional<Error> why_interrupted() {
    const std::lock_guard lock(mutex);
    return interrupted;
  }

  std::optional<Abandon> how_abandoned() {
    const std::lock_guard lock(mutex);
    return abandoned;
  }

  // Nobody goes on with a scan that has ended.
  void remove_checkpoint() const {
    if (const Status removed = setup.blobs->remove(setup.scan_id, kCheckpointName); !removed.ok())
      spdlog::warn("scan {}: its checkpoint is left: {}", setup.scan_id, removed.error().message);
  }

  ScanEnd run() try {
    ScanRun scan(setup, events, queue, durable, wants_mesh);
    scan.go_on();
    if (Status status = scan.take_frames(); !status.ok()) return failed_scan(status.error());
    if (const std::optional<Abandon> how = how_abandoned()) {
      if (*how == Abandon::kToGoOn) scan.leave();
      return {wire::ScanPhase::kRunning, {}, {}, {}};
    }
    Result<wire::Finished> results = scan.write();
    const std::optional<Error> reason = why_interrupted();
    if (!results.ok() && results.error().code == ErrorCode::kIo) return not_stored(*setup.blobs, setup.scan_id, reason, results.error());
    if (!results.ok()) return failed_scan(reason ? in_context(reason->message, results.error()) : results.error());
    if (reason) return {wire::ScanPhase::kInterrupted, *reason, *std::move(results), reason->message};
    return {wire::ScanPhase::kFinished, {}, *std::move(results), scan.last_words()};
  } catch (const SetupError& error) {
    return failed_scan(error.error());
  } catch (const std::exception& error) {
    // Out of memory and what libraries throw: this scan is over, the others are not.
    return failed_scan({ErrorCode::kDevice, std::string("the scan failed: ") + error.what()});
  }
};

ScanWorker::ScanWorker(ScanSetup setup, ScanEvents events) : impl_(std::make_unique<Impl>(std::move(setup), std::move(events))) {
  impl_->thread = std::thread([impl = impl_.get()] {
    ScanEnd end = impl->run();
    if (end.phase != wire::ScanPhase::kRunning) impl->remove_checkpoint();
    // From here on nobody takes frames: they must not pile up.
    impl->queue.close(true);
    impl->events.ended(std::move(end));
  });
}

ScanWorker::~ScanWorker() {
  impl_->queue.close(true);
  impl_->thread.join();
}

std::optional<wire::Frame> ScanWorker::push(wire::Frame frame) { return impl_->queue.push(std::move(frame)); }

void ScanWorker::finish() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->finishing = true;
  }
  impl_->queue.close(false);
}

void ScanWorker::abandon(Abandon how) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->abandoned = how;
  }
  impl_->queue.close(true);
}

void ScanWorker::interrupt(const Error& reason, bool discard) {
  {
    const std::lock_guard lock(impl_->mutex);
    if (!impl_->interrupted && (!impl_->finishing || discard)) impl_->interrupted = reason;
  }
  impl_->queue.close(discard);
}

void ScanWorker::want_mesh(bool wanted) { impl_->wants_mesh = wanted; }

void ScanWorker::frames_durable(std::uint64_t count) { impl_->durable.advance(count); }

std::size_t ScanWorker::waiting_bytes() const { return impl_->queue.waiting_bytes(); }

}  // namespace hermite
