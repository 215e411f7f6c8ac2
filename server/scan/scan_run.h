// One scan from the first frame to its files: what the worker's thread (scan_worker.h) does.
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

namespace hermite {

// On one thread. What it is given outlives it. Errors are those that end a scan: kDevice, kIo.
class ScanRun {
 public:
  // Throws SetupError: the device, the camera.
  ScanRun(const ScanSetup& setup, const ScanEvents& events, FrameQueue& queue, DurableFrames& durable, const std::atomic<bool>& wants_mesh);

  // Where an earlier server was with the scan, as far as there is a checkpoint of it; the rest is worked through again.
  void go_on();

  // While the GPU works on a frame, other threads decode and prepare the next one and encode what the last ones have changed.
  Status take_frames();

  // After the last frame: the files of the result, and the last news for viewers.
  Result<wire::Finished> write();

  // The next server goes on from here. Whatever goes wrong: it has the frame log.
  void leave();

  // What whoever scanned should know of the map, once it is written; empty: nothing.
  std::string last_words() const;

 private:
  using Clock = std::chrono::steady_clock;

  struct Decoding {
    wire::Frame frame;
    Timeline::Stage queued;
    Timeline::Stage decoded;                    // written by the other thread
    std::future<Result<PreparedFrame>> images;  // its destructor waits, and the others live longer
  };
  using DecodingFrame = std::unique_ptr<Decoding>;

  void begin();

  // All up to the one in work, from the log. None, and the camera stays as it is: they are too many for a live scan, or not there in time.
  PastFrames past_frames();

  // kNotFound: there is no checkpoint. After any error the scan is at its beginning.
  Result<RestoredScan> restore();

  // After an error or a throw it may have been taken in part.
  Result<RestoredScan> take(const ScanCheckpoint& checkpoint);

  // Of all frames so far. An error is the device's, with which the scan ends; without memory it goes on without a checkpoint.
  Status write_checkpoint();

  DecodingFrame decode(FrameQueue::Popped popped) const;

  // The next frame, if it is there already.
  Result<DecodingFrame> decode_waiting();

  // From the log, as long as there is something in it to be done again, then from the queue.
  Result<FrameQueue::Popped> pop(std::chrono::milliseconds patience);

  Status take_frame(Decoding& decoding);

  // Ends the update before this one.
  Status start_update();

  // For the surface at once, for the chunks until they are encoded next.
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
  std::uint64_t taken_count_ = 0;  // frames of the log up to the one in work
  std::optional<Replay> replay_;
  Timeline timeline_;  // of the frame in work
  std::unique_ptr<Pipeline> pipeline_;
  std::vector<SlotChange> changes_;  // that are not encoded yet
  ChunkEncoder chunks_;
  bool is_past_new_ = false;
  int frames_since_update_ = 0;
  Clock::time_point updated_at_ = Clock::now();
  std::optional<wire::TrackedFrame> last_tracked_;
  wire::SubmapPoses told_poses_;
  std::uint64_t record_count_ = 0, saved_record_count_ = 0;  // of the frame log: that the pipeline has, and the last checkpoint
  CheckpointWriter checkpoints_;
};

}  // namespace hermite
