// A running scan as the network thread sees it: checks the order and credit of its frames, hands them to the worker, and passes what the
// worker tells on to the camera and the viewers. Everything here belongs to the network thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/service/audience.h"
#include "server/service/scan_worker.h"

namespace hermite {

inline constexpr std::uint64_t kMaxFramesPerScan = 400'000;  // 3.7 hours at 30 Hz; bounds trajectory and report
inline constexpr double kMaxTimestamp_s = 1e11;              // keeps six decimals exact to a few microseconds

// To the camera of a scan.
struct CameraLink {
  std::function<void(wire::ServerMessage)> send;
  std::function<void()> ended;  // the scan is over, everything was sent
};

struct FrameCounts {
  std::uint64_t received = 0;   // valid messages
  std::uint64_t processed = 0;  // by the pipeline
  std::uint64_t dropped = 0;    // live: for a newer one; or refused for their time
};

struct ScanTerms {
  wire::Mode mode = wire::Mode::kBatch;
  std::uint32_t credit_window = 16;  // frames
};

class LiveScan {
 public:
  // `on_ended` is called once, when the results are written (or not); it may destroy nothing of this scan.
  LiveScan(ScanTerms terms, std::shared_ptr<Audience> audience, std::function<void(const ScanEnd&)> on_ended);

  // The worker; between construction and the first frame. Not in the constructor since the worker's events lead back here.
  void start(std::unique_ptr<ScanWorker> worker);

  void attach_camera(CameraLink camera) { camera_ = std::move(camera); }

  // An error breaks the rules of order or credit: the session is to be closed. Anything else wrong with a frame is told to the camera and
  // the scan goes on.
  Status receive(wire::Frame frame);
  void finish();
  void camera_left(const Error& why);  // nothing more comes from it, and nothing is sent to it
  void stop();                         // the server is stopping

  // Told by the worker, through the network thread.
  void frame_done(const FrameOutcome& outcome);
  void model_changed(ModelUpdate update);
  void ended(ScanEnd end);

  const FrameCounts& counts() const { return counts_; }
  const Audience& audience() const { return *audience_; }
  std::shared_ptr<Audience> shared_audience() const { return audience_; }
  wire::Mode mode() const { return terms_.mode; }
  std::uint64_t credit() const { return counts_.processed + counts_.dropped + terms_.credit_window - counts_.received; }
  std::uint64_t queue_bytes() const { return worker_ ? worker_->waiting_bytes() : 0; }
  std::uint64_t gpu_memory_bytes() const { return gpu_memory_bytes_; }
  bool over() const { return phase_ != wire::ScanPhase::kRunning; }

 private:
  void send(wire::ServerMessage message);
  void refuse(std::uint64_t sequence, const Error& error);
  void grant();
  wire::ScanState state(const std::string& words) const;

  const ScanTerms terms_;
  const std::shared_ptr<Audience> audience_;
  const std::function<void(const ScanEnd&)> on_ended_;
  std::unique_ptr<ScanWorker> worker_;
  std::optional<CameraLink> camera_;
  wire::ScanPhase phase_ = wire::ScanPhase::kRunning;
  FrameCounts counts_;
  std::uint64_t keyframes_ = 0, loops_ = 0, gpu_memory_bytes_ = 0;  // as of the last update of the model
  std::optional<double> last_timestamp_s_;
  bool finishing_ = false;
};

}  // namespace hermite
