// Processes one scan from the first frame to its result files, on the worker's thread
// (scan_worker.h).
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/timeline.h"
#include "core/pipeline/pipeline.h"
#include "server/scan/checkpoint_writer.h"
#include "server/scan/chunk_encoder.h"
#include "server/scan/frame_queue.h"
#include "server/scan/live_mesher.h"
#include "server/scan/replay.h"
#include "server/scan/scan_worker.h"

namespace hermite::server {

// Used by one thread. Its arguments outlive it. Errors end the scan: kDevice, kIo.
class ScanRun {
 public:
  // Throws SetupError for the device or the camera.
  ScanRun(const ScanSetup& setup, const ScanEvents& events, FrameQueue& queue,
          DurableFrames& durable, const std::atomic<bool>& wants_mesh);

  // Restores the last checkpoint of an earlier server, if any; later frames are processed again.
  void go_on();

  // While the GPU processes a frame, other threads decode and prepare the next one and encode
  // earlier changes.
  Status take_frames();

  // After the last frame: writes the result files and sends viewers the final update.
  Result<wire::Finished> write();

  // Stores a checkpoint for the next server. Errors are only logged: the frame log has everything.
  void leave();

  // A remark about the map for the user, after the results are written; may be empty.
  std::string last_remark() const;

 private:
  using Clock = std::chrono::steady_clock;

  struct Decoding {
    wire::Frame frame;
    Timeline::Stage queued;
    Timeline::Stage decoded;  // written by the decoding thread
    // Declared last: its destructor waits for the task.
    std::future<Result<frame::PreparedFrame>> images;
  };
  using DecodingFrame = std::unique_ptr<Decoding>;

  void begin();

  // All frames up to the current one, from the log. None, and the camera is kept: too many for a
  // live scan, or not in time.
  pipeline::PastFrames past_frames();

  // kNotFound: there is no checkpoint. After any error the scan starts from the beginning.
  Result<RestoredScan> restore();

  // After an error or exception the state may be partly restored.
  Result<RestoredScan> take(const ScanCheckpoint& checkpoint);

  // A checkpoint of all frames so far. Device errors end the scan; if memory is short the scan
  // continues without a checkpoint.
  Status write_checkpoint();

  DecodingFrame decode(FrameQueue::Popped popped) const;

  // The next frame, if it is available already.
  Result<DecodingFrame> decode_waiting();

  // From the log while it has frames to be replayed, then from the queue.
  Result<FrameQueue::Popped> pop(std::chrono::milliseconds patience);

  Status take_frame(Decoding& decoding);

  // Finishes the previous update.
  Status start_update();

  // Passes changes to the surface at once, and keeps them for the next encoding of chunks.
  Status take_changes();

  Status tell_viewers();

  Status tell_viewers_if_encoded();

  Status put(const char* name, const std::string& bytes) const;

  const ScanSetup& setup_;
  const ScanEvents& events_;
  FrameQueue& queue_;
  DurableFrames& durable_;
  const std::atomic<bool>& wants_mesh_;
  MeshFeed mesh_;
  std::uint64_t taken_count_ = 0;  // frames of the log up to the current one
  std::optional<Replay> replay_;
  Timeline timeline_;  // of the current frame
  std::unique_ptr<pipeline::Pipeline> pipeline_;
  std::vector<output::SlotChange> changes_;  // not encoded yet
  ChunkEncoder chunks_;
  bool is_past_new_ = false;
  int frames_since_update_ = 0;
  Clock::time_point updated_at_ = Clock::now();
  std::optional<wire::TrackedFrame> last_tracked_;
  wire::SubmapPoses told_poses_;
  // Records of the frame log that the pipeline, and the last checkpoint, include.
  std::uint64_t record_count_ = 0, saved_record_count_ = 0;
  CheckpointWriter checkpoints_;
};

}  // namespace hermite::server
