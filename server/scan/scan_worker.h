// The thread that owns the pipeline of one scan: takes frames from a bounded queue, reconstructs,
// and reports the results.
//
// The pipeline is created, used and destroyed on that thread. Nothing here touches a socket or the
// store; results are reported through ScanEvents, which are called on the worker's thread and are
// expected to post to another thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/adjust/mapping.h"
#include "core/base/result.h"
#include "core/base/timeline.h"
#include "core/math/camera.h"
#include "core/mesh/live_surface.h"
#include "core/output/chunks.h"
#include "core/pipeline/options.h"
#include "proto/wire/messages.h"
#include "server/store/blobs.h"

namespace hermite::server {

// Viewers get updates of the model after this many frames or this much time, whichever comes first.
// This does not influence poses or the cloud.
inline constexpr int kFramesPerUpdate = 15;
inline constexpr int kMsPerUpdate = 500;

using SharedBytes = std::shared_ptr<const std::string>;

struct ScanSetup {
  std::string device;
  Camera camera;
  pipeline::Options options;
  wire::DepthCodec depth_codec = wire::DepthCodec::kRvlZstd;
  std::size_t queue_capacity = 16;  // frames
  std::string scan_id;
  Blobs* blobs = nullptr;  // for the results; outlives the worker
  adjust::CorrectionTime correction_time = adjust::CorrectionTime::kByFrames;
  // The folder of the frame log, which is read again after a recalibration. Empty: none.
  std::string log_folder;
  // For a scan that an earlier server began: this many records of its frame log are processed
  // before pushed frames.
  std::uint64_t replayed_record_count = 0;
  std::uint64_t replayed_frame_count = 0;          // frames among these, including refused ones
  std::chrono::milliseconds checkpoint_period{0};  // of checkpoints (checkpoint_file.h); 0: none
};

// What was restored from a checkpoint: frames without individual events.
struct RestoredScan {
  // Frames that an earlier server processed; 0: all frames are processed again.
  std::uint64_t processed = 0;
  // Dropped frames before the last of these, without refused ones.
  std::uint64_t dropped = 0;
  std::vector<wire::PoseInSubmap> past;  // poses of the camera
  wire::SubmapPoses poses;
  std::string why_not;  // why an existing checkpoint cannot be used
};

struct FrameOutcome {
  wire::FrameResult result;
  // When submaps were added or moved; sent before the result, so that everything moves together.
  std::optional<wire::SubmapPoses> poses;
  // When the map was rebuilt: the poses of earlier frames.
  std::optional<std::vector<wire::PoseInSubmap>> past;
  Timeline::Clock::time_point arrived;  // when it entered the queue
  double work_ms = 0;                   // without the time in the queue
  // In order: queue, decoding, stages of the pipeline.
  std::vector<Timeline::Stage> stages;
  // Why the pipeline got an empty frame instead of these images.
  std::optional<Error> bad_images;
};

// A formatted chunk message, shared by all viewers.
struct ChunkUpdate {
  output::ChunkKey key;
  bool empty = false;
  SharedBytes message;
};

struct ModelUpdate {
  std::vector<ChunkUpdate> chunks;
  wire::SubmapPoses poses;
  std::optional<std::vector<wire::PoseInSubmap>> past;  // as in FrameOutcome, for all frames
  std::uint64_t keyframes = 0, loops = 0;               // so far
  std::optional<UpDirection> up;                        // as measured so far
  std::uint64_t gpu_memory_bytes = 0;                   // of the scan
  std::uint64_t device_memory_bytes = 0;                // total memory of the device; 0: unknown
  Timeline::Stage encoding;                             // of `chunks`
};

// Like ChunkUpdate, for the surface.
struct MeshPiece {
  mesh::SurfaceCube cube;
  bool empty = false;
  SharedBytes message;
};

struct MeshUpdate {
  std::vector<MeshPiece> pieces;
  // The map is too large: the surface ends and all pieces are empty.
  bool ended = false;
  Timeline::Stage work;  // on the pieces
  // Time since the arrival of the first frame whose changes they show.
  std::chrono::steady_clock::duration delay{};
};

struct ScanEnd {
  wire::ScanPhase phase = wire::ScanPhase::kFinished;  // running: abandoned
  Error error;                                         // when failed, or why it was interrupted
  wire::Finished results;                              // when not failed
  // For the user: the error, or a remark about the map.
  std::string message;
  bool discarded = false;  // nothing is kept
  // Interrupted: the results could not be stored, but the frames exist.
  bool results_missing = false;
};

// `ended` is always the last event and comes exactly once.
struct ScanEvents {
  // For a scan that an earlier server began: once, before all other events.
  std::function<void(RestoredScan)> restored;
  // Once for every frame taken from the queue, in order.
  std::function<void(FrameOutcome)> frame_done;
  std::function<void(ModelUpdate)> model_changed;
  std::function<void(MeshUpdate)> mesh_changed;  // on another thread; never after `ended`
  // Why there are no results for some seconds; empty: they continue.
  std::function<void(std::string)> says;
  std::function<void(ScanEnd)> ended;
};

// kToGoOn: another worker continues from what this one stores.
enum class Abandon { kForGood, kToGoOn };

// Used by one thread.
class ScanWorker {
 public:
  ScanWorker(ScanSetup setup, ScanEvents events);  // starts the thread
  // Ends the thread: drops waiting frames and waits for the current one.
  ~ScanWorker();
  ScanWorker(const ScanWorker&) = delete;
  ScanWorker& operator=(const ScanWorker&) = delete;

  // Never blocks. Returns the oldest queued frame if it was dropped to make room.
  std::optional<wire::Frame> push(wire::Frame frame);

  // No more frames: the worker processes the queue, writes the results and ends as finished.
  void finish();

  // Like finish(), but ends as interrupted for the given reason. `discard` drops the frames in the
  // queue. After finish() this has an effect only with `discard`.
  void interrupt(const Error& reason, bool discard);

  // Ends after the current frame, without results; the reported phase is `running`.
  void abandon(Abandon how);

  void want_mesh(bool wanted);  // whether any viewer shows a surface; initially false

  void frames_durable(std::uint64_t count);  // this many are on disk; checkpoints include no others
  std::size_t waiting_bytes() const;         // of queued frames

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite::server
