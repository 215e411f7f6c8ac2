// The thread that owns one scan's pipeline: takes frames from a bounded queue, reconstructs, and tells what came of it.
//
// The pipeline is made, used and destroyed on that thread. Nothing here touches a socket or the store; what happens is told through
// ScanEvents, which are called on the worker's thread and are expected to hand over to another one.
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

namespace hermite {

// Viewers are told of a changed model after this many frames or this much time, whichever comes first. It has no influence on poses or
// cloud.
inline constexpr int kFramesPerUpdate = 15;
inline constexpr int kMsPerUpdate = 500;

using SharedBytes = std::shared_ptr<const std::string>;

struct ScanSetup {
  std::string device;
  Camera camera;
  Options options;
  wire::DepthCodec depth_codec = wire::DepthCodec::kRvlZstd;
  std::size_t queue_capacity = 16;  // frames
  std::string scan_id;
  Blobs* blobs = nullptr;  // for the results; outlives the worker
  CorrectionTime correction_time = CorrectionTime::kByFrames;
  // Where all that is pushed is logged too, and is read again when the camera turns out to be off. Empty: nowhere.
  std::string log_folder;
  // Of a scan that a server before this one began: the first so many records of its frame log come before all that is pushed.
  std::uint64_t replayed_record_count = 0;
  std::uint64_t replayed_frame_count = 0;          // among these, with the refused ones
  std::chrono::milliseconds checkpoint_period{0};  // so often what the scan has come to is stored (checkpoint_file.h); 0: never
};

// What a checkpoint had of such a scan: frames that are not told of one by one.
struct RestoredScan {
  std::uint64_t processed = 0;           // by the pipeline of an earlier server; 0: all frames are worked through again
  std::uint64_t dropped = 0;             // of those before the last of them, beside the refused ones
  std::vector<wire::PoseInSubmap> past;  // where the camera was
  wire::SubmapPoses poses;
  std::string why_not;  // a checkpoint that is there cannot be used: in words
};

struct FrameOutcome {
  wire::FrameResult result;
  std::optional<wire::SubmapPoses> poses;  // when submaps came or moved: told before the result, so that all of it moves at once
  std::optional<std::vector<wire::PoseInSubmap>> past;  // when the map was made anew: where the camera was in the frames before
  Timeline::Clock::time_point arrived;                  // when it began to wait in the queue
  double work_ms = 0;                                   // from the end of its waiting on
  std::vector<Timeline::Stage> stages;                  // in the order of time: the queue, decoding, those of the pipeline
  std::optional<Error> bad_images;                      // why the pipeline got an empty frame instead of this one's images
};

// A chunk message ready to be sent, made once for all viewers.
struct ChunkUpdate {
  ChunkKey key;
  bool empty = false;
  SharedBytes message;
};

struct ModelUpdate {
  std::vector<ChunkUpdate> chunks;
  wire::SubmapPoses poses;
  std::optional<std::vector<wire::PoseInSubmap>> past;  // as in FrameOutcome, but of all frames
  std::uint64_t keyframes = 0, loops = 0;               // so far
  std::uint64_t gpu_memory_bytes = 0;                   // of the scan
  std::uint64_t device_memory_bytes = 0;                // that there is for all of them; 0: nobody knows
  Timeline::Stage encoding;                             // of `chunks`
};

// As ChunkUpdate, of the surface.
struct MeshPiece {
  SurfaceCube cube;
  bool empty = false;
  SharedBytes message;
};

struct MeshUpdate {
  std::vector<MeshPiece> pieces;
  bool ended = false;                           // the map is too large: nothing more comes, and all pieces are empty
  Timeline::Stage work;                         // on the pieces
  std::chrono::steady_clock::duration delay{};  // since the first frame with a change that they show came to the server
};

struct ScanEnd {
  wire::ScanPhase phase = wire::ScanPhase::kFinished;  // running: abandoned
  Error error;                                         // when failed, or why it was interrupted
  wire::Finished results;                              // when not failed
  std::string words;                                   // for a person: the error's, or what is left to say about the map
  bool discarded = false;                              // nothing of it is to be kept
  bool results_missing = false;                        // interrupted: the disk did not take them, and its frames are there
};

// The last event is `ended`, always and once.
struct ScanEvents {
  std::function<void(RestoredScan)> restored;    // of a scan that an earlier server began: once, before all others
  std::function<void(FrameOutcome)> frame_done;  // once for every frame taken from the queue, in order
  std::function<void(ModelUpdate)> model_changed;
  std::function<void(MeshUpdate)> mesh_changed;  // on a thread of its own; none after `ended`
  std::function<void(std::string)> says;         // why nothing comes for seconds; empty: it goes on
  std::function<void(ScanEnd)> ended;
};

enum class Abandon { kForGood, kToGoOn };  // another worker goes on from what this one stores

// Call from one thread.
class ScanWorker {
 public:
  ScanWorker(ScanSetup setup, ScanEvents events);  // starts the thread
  ~ScanWorker();                                   // ends it: drops waiting frames and waits for the one in work
  ScanWorker(const ScanWorker&) = delete;
  ScanWorker& operator=(const ScanWorker&) = delete;

  // Never blocks. Returns the frame that had to make room: the oldest in the queue.
  std::optional<wire::Frame> push(wire::Frame frame);

  // All frames have come: the worker takes those in the queue, writes the results and ends as finished.
  void finish();

  // As finish(), but ends as interrupted for the reason given. With `discard` frames in the queue are dropped.
  // After finish() only a discard has an effect.
  void interrupt(const Error& reason, bool discard);

  // Ends after the frame in work, without results: the phase that is told is `running`.
  void abandon(Abandon how);

  void want_mesh(bool wanted);  // does anybody watch a surface? Nobody does to begin with

  void frames_durable(std::uint64_t count);  // so many are: what is stored of the scan rests on no others
  std::size_t waiting_bytes() const;         // of frames in the queue

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite
