// A running scan as the network thread sees it: checks the order and credit of its frames, hands them to the frame log and the worker, and
// passes what these tell on to the camera and the viewers. It outlives the connection of its camera, for a while.
// Everything here belongs to the network thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/log/frame_log.h"
#include "proto/wire/messages.h"
#include "server/scan/audience.h"
#include "server/scan/scan_worker.h"

namespace hermite {

inline constexpr std::uint64_t kMaxFramesPerScan = 400'000;  // 3.7 hours at 30 Hz; bounds trajectory and report
// A coffee break. A camera that is paused for longer than that keeps others from their scans.
inline constexpr std::chrono::minutes kMaxPause(30);
inline constexpr double kMaxTimestamp_s = 1e11;  // keeps six decimals exact to a few microseconds

// To the camera of a scan.
struct CameraLink {
  std::function<void(wire::ServerMessage)> send;
  std::function<void()> ended;       // the scan is over, everything was sent
  std::function<void()> superseded;  // another connection has taken the scan over
  std::function<void()> go_away;     // the server stops, the scan does not: it goes on when there is a server again
};

struct FrameCounts {
  std::uint64_t received = 0;   // valid messages
  std::uint64_t processed = 0;  // by the pipeline
  std::uint64_t dropped = 0;    // live: for a newer one; or refused for their time
};

struct ScanTerms {
  wire::Mode mode = wire::Mode::kBatch;
  std::uint32_t credit_window = 16;  // frames
  std::string resume_token_sha256;   // empty: the scan ends with its camera's connection
  std::chrono::milliseconds resume_window{120'000};
  std::chrono::milliseconds frame_patience{120'000};  // for a camera that could send a frame and does not
  std::uint64_t expected_frames = 0;                  // 0: nobody knows
};

// What an earlier server has taken of a scan, as its frame log has it.
struct ScanPast {
  std::uint64_t received = 0;  // frames, with the refused ones
  std::uint64_t refused = 0;
  std::optional<double> last_timestamp_s;
  bool finished = false;  // nothing more is to come
};

class LiveScan {
 public:
  using Clock = std::chrono::steady_clock;

  // `on_ended` is called once, when the results are written (or not); it may destroy nothing of this scan.
  LiveScan(ScanTerms terms, const ScanPast& past, std::shared_ptr<Audience> audience, std::function<void(const ScanEnd&)> on_ended);
  ~LiveScan() { audience_->tell_mesh_wanted(nullptr); }
  LiveScan(const LiveScan&) = delete;
  LiveScan& operator=(const LiveScan&) = delete;

  // The worker and the log; between construction and the first frame. Not in the constructor since their events lead back here.
  void start(std::unique_ptr<ScanWorker> worker, std::unique_ptr<FrameLog> log);

  // The camera from now on; one that was there before is told that it is superseded. The number names this link in camera_left().
  std::uint64_t attach_camera(CameraLink camera);

  // For a camera that comes back and still has the frames from `next_sequence` on. An error, in words for it, when it cannot go on.
  Result<wire::Resumed> resume(std::uint64_t next_sequence);

  // An error breaks the rules of order or credit: the session is to be closed. Anything else wrong with a frame is told to the camera and
  // the scan goes on. `message` is the whole message that the frame came in.
  Status receive(wire::Frame frame, std::string_view message);
  void finish();
  void pause(bool paused);
  void discard();

  // Nothing more comes over that link, and nothing is sent to it. The scan waits for another one if the camera can come back, and did not
  // break a rule.
  void camera_left(std::uint64_t link, const Error& why, bool broke_rule);

  void wait_for_camera(const Error& why);  // of a scan with a past that is not finished

  void tick(Clock::time_point now);  // now and then: ends a wait that has taken too long, for a camera to come back or to send a frame
  void stop();                       // the server is stopping

  // Of a scan that is rebuilt from its frames, or that somebody stops: no camera is waited for.
  void end_with(const Error& why) { end_early(why); }
  void no_more_room(const Error& why);  // for frames: its results still fit
  void warn(const std::string& words);  // told to camera and viewers until it is something else; empty: nothing

  // What its results come to, or less than that: what has to stay free on the disk for them.
  std::uint64_t results_bytes() const;

  // Told by the log, through the network thread.
  void frames_durable(std::uint64_t count);
  void log_failed(const Error& error);

  // Told by the worker, through the network thread.
  void restored(RestoredScan restored);
  void frame_done(const FrameOutcome& outcome);
  void model_changed(ModelUpdate update);
  void mesh_changed(MeshUpdate update);
  void worker_says(const std::string& words);  // told to camera and viewers until it is something else; empty: nothing
  void ended(ScanEnd end);

  const FrameCounts& counts() const { return counts_; }
  const Audience& audience() const { return *audience_; }
  std::shared_ptr<Audience> shared_audience() const { return audience_; }
  const std::string& resume_token_sha256() const { return terms_.resume_token_sha256; }
  // Nothing where nobody knows how many there will be.
  std::optional<std::uint64_t> remaining_frames() const {
    const std::uint64_t done = counts_.processed + counts_.dropped;
    if (terms_.expected_frames == 0) return std::nullopt;
    return terms_.expected_frames > done ? terms_.expected_frames - done : 0;
  }
  wire::Mode mode() const { return terms_.mode; }
  std::uint64_t credit() const { return counts_.processed + counts_.dropped + terms_.credit_window - counts_.received; }
  std::uint64_t queue_bytes() const { return worker_ ? worker_->waiting_bytes() : 0; }
  std::uint64_t gpu_memory_bytes() const { return gpu_memory_bytes_; }
  // It has ended, or is ending, because there was no room for more frames, or for its results.
  bool lacked_room() const { return lacked_room_; }
  bool takes_frames() const { return !no_more_frames() && !finishing_; }
  bool over() const { return phase_ != wire::ScanPhase::kRunning; }

 private:
  void send(wire::ServerMessage message);
  void refuse(std::uint64_t sequence, const Error& error);
  void grant();
  std::uint64_t granted() const;
  bool no_more_frames() const { return over() || ending_; }
  bool resumable() const { return !terms_.resume_token_sha256.empty(); }
  Status log_record(RecordType type, std::string_view message);
  void end_early(const Error& why);
  void end_silence(Clock::time_point now);
  void show_state();
  wire::ScanState state(const std::string& words) const;

  const ScanTerms terms_;
  const std::shared_ptr<Audience> audience_;
  const std::function<void(const ScanEnd&)> on_ended_;
  std::unique_ptr<ScanWorker> worker_;
  std::unique_ptr<FrameLog> log_;
  std::optional<CameraLink> camera_;
  std::uint64_t camera_number_ = 0;                 // of the links so far
  std::optional<Clock::time_point> waiting_since_;  // for a camera to come back
  std::optional<Clock::time_point> silent_since_;   // the camera, that could send a frame
  Error why_waiting_;
  wire::ScanPhase phase_ = wire::ScanPhase::kRunning;
  FrameCounts counts_;
  std::uint64_t durable_ = 0;                                       // frames
  std::uint64_t keyframes_ = 0, loops_ = 0, gpu_memory_bytes_ = 0;  // as of the last update of the model
  std::optional<double> last_timestamp_s_;
  std::uint64_t surfel_count_ = 0;  // as of the last frame
  std::string warning_;
  std::string words_of_worker_;
  bool mesh_ended_ = false;
  bool finishing_ = false;  // every frame was received
  bool ending_ = false;     // before every frame was: nothing more is received
  bool discarded_ = false;
  bool lacked_room_ = false;
  bool paused_ = false;  // by its camera
};

}  // namespace hermite
