// The network thread's side of a running scan: checks the order and credit of its frames, passes them to the frame log and the worker, and
// forwards their events to the camera and the viewers. It survives a lost connection of its camera for a while.
// Everything here belongs to the network thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/log/frame_log.h"
#include "proto/wire/messages.h"
#include "server/scan/arrivals.h"
#include "server/scan/scan_camera.h"
#include "server/scan/scan_worker.h"
#include "server/scan/subscribers.h"

namespace hermite {

inline constexpr std::uint64_t kMaxFramesPerScan = 400'000;  // 3.7 hours at 30 Hz; bounds trajectory and report
inline constexpr double kMaxTimestamp_s = 1e11;              // so that six decimals are exact to a few microseconds

struct FrameCounts {
  std::uint64_t received = 0;   // valid messages
  std::uint64_t processed = 0;  // by the pipeline
  std::uint64_t dropped = 0;    // in live mode for a newer frame, or refused for their timestamp
};

struct ScanTerms {
  wire::Mode mode = wire::Mode::kBatch;
  std::uint32_t credit_window = 16;  // frames
  std::string resume_token_sha256;   // empty: the scan ends when its camera disconnects
  std::chrono::milliseconds resume_window{120'000};
  std::chrono::milliseconds frame_patience{120'000};  // how long a camera with credit may send nothing
  std::uint64_t expected_frames = 0;                  // 0: unknown
};

// The part of a scan that an earlier server received, from its frame log.
struct ScanPast {
  std::uint64_t received = 0;  // frames, including refused ones
  std::uint64_t refused = 0;
  std::optional<double> last_timestamp_s;
  bool finished = false;  // all frames were received
};

class LiveScan {
 public:
  using Clock = std::chrono::steady_clock;

  // `on_ended` is called once, when the results are written or have failed; it must not destroy this scan.
  LiveScan(ScanTerms terms, const ScanPast& past, std::shared_ptr<Subscribers> subscribers, std::function<void(const ScanEnd&)> on_ended);
  ~LiveScan() { subscribers_->tell_mesh_wanted(nullptr); }
  LiveScan(const LiveScan&) = delete;
  LiveScan& operator=(const LiveScan&) = delete;

  // Sets the worker and the log, before the first frame. Not in the constructor, since their events refer to this object.
  void start(std::unique_ptr<ScanWorker> worker, std::unique_ptr<FrameLog> log);

  // The returned number identifies the link in camera_left().
  std::uint64_t attach_camera(CameraLink camera);

  // For a camera that reconnects and still has the frames from `next_sequence` on. The error tells it why it cannot continue.
  Result<wire::Resumed> resume(std::uint64_t next_sequence);

  // An error means a violation of order or credit: close the session. Any other problem with a frame is reported to the camera and the scan
  // continues. `message` is the whole message of the frame.
  Status receive(wire::Frame frame, std::string_view message);
  void finish();
  void pause(bool paused);           // its camera has paused, or goes on
  Status ask_to_pause(bool paused);  // as ScanCamera; kBusy also when the scan takes no frames any more
  void discard();

  // The link is closed in both directions. The scan waits for a new one if the camera can reconnect and did not violate the
  // protocol.
  void camera_left(std::uint64_t link, const Error& why, bool broke_rule);

  void wait_for_camera(const Error& why);  // for a scan that an earlier server left unfinished

  void tick(Clock::time_point now);  // called periodically: ends waits for a camera that have timed out
  void stop();                       // the server is stopping

  // Ends the scan without waiting for a camera: it is being rebuilt from its frames, or a person stops it.
  void end_with(const Error& why) { end_early(why); }
  void no_more_room(const Error& why);    // no room for more frames; its results still fit
  void warn(const std::string& message);  // shown to camera and viewers until replaced; empty: nothing

  // An upper bound of the size of its results, which must stay free on the disk.
  std::uint64_t results_bytes() const;

  // Events of the log, posted to the network thread.
  void frames_durable(std::uint64_t count);
  void log_failed(const Error& error);

  // Events of the worker, posted to the network thread.
  void restored(RestoredScan restored);
  void frame_done(const FrameOutcome& outcome);
  void model_changed(ModelUpdate update);
  void mesh_changed(MeshUpdate update);
  void worker_says(const std::string& message);  // shown to camera and viewers until replaced; empty: nothing
  void ended(ScanEnd end);

  const FrameCounts& counts() const { return counts_; }
  const Subscribers& subscribers() const { return *subscribers_; }
  std::shared_ptr<Subscribers> shared_subscribers() const { return subscribers_; }
  const Arrivals& arrivals() const { return arrivals_; }
  std::uint64_t durable_frames() const { return durable_; }  // frames 0 to this one (exclusive) can be read from the log
  const std::string& resume_token_sha256() const { return terms_.resume_token_sha256; }
  // None if the number of frames is unknown.
  std::optional<std::uint64_t> remaining_frames() const {
    const std::uint64_t done = counts_.processed + counts_.dropped;
    if (terms_.expected_frames == 0) return std::nullopt;
    return terms_.expected_frames > done ? terms_.expected_frames - done : 0;
  }
  wire::Mode mode() const { return terms_.mode; }
  std::uint64_t credit() const { return counts_.processed + counts_.dropped + terms_.credit_window - counts_.received; }
  std::uint64_t queue_bytes() const { return worker_ ? worker_->waiting_bytes() : 0; }
  std::uint64_t gpu_memory_bytes() const { return gpu_memory_bytes_; }
  // Whether it has ended, or is ending, because there was no room for more frames or for its results.
  bool lacked_room() const { return lacked_room_; }
  bool takes_frames() const { return !no_more_frames() && !finishing_; }
  bool over() const { return phase_ != wire::ScanPhase::kRunning; }

 private:
  void refuse(std::uint64_t sequence, const Error& error);
  void grant();
  std::uint64_t granted() const;
  bool no_more_frames() const { return over() || ending_; }
  bool resumable() const { return !terms_.resume_token_sha256.empty(); }
  Status log_record(RecordType type, std::string_view message);
  void end_early(const Error& why);
  void show_state();
  std::string message() const;
  wire::ScanState state(const std::string& message) const;

  const ScanTerms terms_;
  const std::shared_ptr<Subscribers> subscribers_;
  const std::function<void(const ScanEnd&)> on_ended_;
  std::unique_ptr<ScanWorker> worker_;
  std::unique_ptr<FrameLog> log_;
  ScanCamera camera_;
  Error why_ending_;
  wire::ScanPhase phase_ = wire::ScanPhase::kRunning;
  FrameCounts counts_;
  std::uint64_t durable_ = 0;                                       // frames
  std::uint64_t keyframes_ = 0, loops_ = 0, gpu_memory_bytes_ = 0;  // from the last update of the model
  std::optional<double> last_timestamp_s_;
  std::uint64_t surfel_count_ = 0;  // from the last frame
  std::string warning_;
  std::string worker_message_;
  bool mesh_ended_ = false;
  bool finishing_ = false;  // all frames were received
  bool ending_ = false;     // ends early: no more frames are accepted
  bool discarded_ = false;
  bool lacked_room_ = false;
  Arrivals arrivals_;
};

}  // namespace hermite
