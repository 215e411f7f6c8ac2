// The network thread's side of a running scan: passes the frames of its camera to the frame log and
// the worker, and their events to the camera and the viewers. It survives a lost connection of its
// camera for a while. Its parts have the rules: which frames may come (received_frames.h), when and
// how it ends (scan_lifecycle.h), and what is shown of it (live_display.h). Everything here belongs
// to the network thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/log/frame_log.h"
#include "proto/wire/messages.h"
#include "server/scan/live_display.h"
#include "server/scan/received_frames.h"
#include "server/scan/scan_camera.h"
#include "server/scan/scan_lifecycle.h"
#include "server/scan/scan_worker.h"
#include "server/scan/subscribers.h"

namespace hermite::server {

struct ScanTerms {
  wire::Mode mode = wire::Mode::kBatch;
  std::uint32_t credit_window = 16;  // frames
  std::string resume_token_sha256;   // empty: the scan ends when its camera disconnects
  std::chrono::milliseconds resume_window{120'000};
  // How long a camera with credit may send nothing.
  std::chrono::milliseconds frame_patience{120'000};
  std::uint64_t expected_frames = 0;  // 0: unknown

  bool resumable() const { return !resume_token_sha256.empty(); }
};

class LiveScan {
 public:
  using Clock = std::chrono::steady_clock;

  // `on_ended` is called once, when the results are written or have failed; it must not destroy
  // this scan.
  LiveScan(ScanTerms terms, const ScanPast& past, std::shared_ptr<Subscribers> subscribers,
           std::function<void(const ScanEnd&)> on_ended);
  ~LiveScan();
  LiveScan(const LiveScan&) = delete;
  LiveScan& operator=(const LiveScan&) = delete;

  // Sets the worker and the log, before the first frame. Not in the constructor, since their events
  // refer to this object.
  void start(std::unique_ptr<ScanWorker> worker, std::unique_ptr<frame_log::FrameLog> log);

  // The returned number identifies the link in camera_left().
  std::uint64_t attach_camera(CameraLink camera);

  // For a camera that reconnects and still has the frames from `next_sequence` on. The error tells
  // it why it cannot continue.
  Result<wire::Resumed> resume(std::uint64_t next_sequence);

  // An error means a violation of order or credit: close the session. Any other problem with a
  // frame is reported to the camera and the scan continues. `message` is the whole message of the
  // frame.
  Status receive(wire::Frame frame, std::string_view message);
  void finish();
  void pause(bool paused);  // its camera has paused, or goes on
  // As ScanCamera; kBusy also when the scan takes no frames any more.
  Status ask_to_pause(bool paused);
  void discard();

  // The link is closed in both directions. The scan waits for a new one if the camera can reconnect
  // and did not violate the protocol.
  void camera_left(std::uint64_t link, const Error& why, bool broke_rule);

  void wait_for_camera(const Error& why);  // for a scan that an earlier server left unfinished

  // Called periodically: ends waits for a camera that have timed out.
  void tick(Clock::time_point now);
  void stop();  // the server is stopping

  // Ends the scan with the frames that it has, without waiting for a camera: it is being rebuilt
  // from them, a person stops it, or there is no room for more. Does nothing when it is ending
  // already, or has all its frames.
  void end_early(const Error& why, EndCause cause = EndCause::kOther);

  // An upper bound of the size of its results, which must stay free on the disk.
  std::uint64_t results_bytes() const;

  // Events of the log, posted to the network thread.
  void frames_durable(std::uint64_t count);
  void log_failed(const Error& error);

  // Events of the worker, posted to the network thread. Others go to the display.
  void restored(RestoredScan restored);
  void frame_done(const FrameOutcome& outcome);
  void ended(ScanEnd end);

  const std::shared_ptr<Subscribers>& subscribers() const { return subscribers_; }
  const ScanTerms& terms() const { return terms_; }
  const ReceivedFrames& frames() const { return frames_; }
  const ScanLifecycle& lifecycle() const { return lifecycle_; }
  const LiveDisplay& display() const { return display_; }
  LiveDisplay& display() { return display_; }
  std::uint64_t queue_bytes() const { return worker_ ? worker_->waiting_bytes() : 0; }

 private:
  Status log_record(frame_log::RecordType type, std::string_view message);

  const ScanTerms terms_;
  const std::shared_ptr<Subscribers> subscribers_;
  const std::function<void(const ScanEnd&)> on_ended_;
  std::unique_ptr<ScanWorker> worker_;
  std::unique_ptr<frame_log::FrameLog> log_;
  ScanCamera camera_;
  ReceivedFrames frames_;
  ScanLifecycle lifecycle_;
  LiveDisplay display_;
  std::uint64_t surfel_count_ = 0;  // from the last frame
};

}  // namespace hermite::server
