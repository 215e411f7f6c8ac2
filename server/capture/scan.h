// One scan with an attached camera: checks its first frames, sends frames to the server until the
// user ends the scan, and waits for the result.
//
// Without a recording the scan is live: frames that the link or the server cannot take are dropped
// and counted. With a recording, every frame is written to a local log and sent from there, in
// order and without drops (batch): while the server is unreachable the camera continues, and the
// missing frames are sent later. If the server has given up the scan meanwhile, the whole log is
// sent again as a new scan.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "server/capture/camera.h"
#include "server/capture/capture.h"
#include "server/capture/local_log.h"
#include "server/capture/preflight.h"
#include "server/client/stream.h"

namespace hermite::client {

struct ScanRequest {
  std::optional<StreamRequest> stream{};  // std::nullopt: only record. Its pacing is ignored
  std::string title{};
  // Must not exist; empty: no recording (CHECKs that there is a stream).
  std::string record_folder{};
  // 0: until an interrupt, or the end of the camera.
  std::uint64_t max_frames = 0;
  // kMin to kMaxPreflightFrames (CHECK); they are not part of the scan.
  int preflight_frames = kPreflightFrames;
  std::chrono::milliseconds camera_patience{10'000};  // for each of the first frames
  // Patience with an unreachable server, once all is recorded.
  std::chrono::milliseconds server_patience{600'000};
};

inline constexpr int kMinPreflightFrames = 3;   // the depth codec is chosen with them
inline constexpr int kMaxPreflightFrames = 90;  // they are held in memory: 1.5 MB each at 640x480

struct ScanProgress {
  StreamProgress stream;  // of the current or last connection
  CaptureState capture;
  std::optional<LocalLog::State> log;
  std::uint64_t dropped_frames = 0;  // by camera, computer, link and server
};

// Each may be empty. All except `wishes` are called on the thread of run_scan.
struct ScanObserver {
  // As Capture::Events: first on this thread, then on another.
  std::function<CaptureWishes()> wishes{};
  std::function<void(const ScanProgress&)> on_progress{};  // several times per second
  // Messages of the pre-flight check, about the link, about single frames.
  std::function<void(const std::string& message)> on_message{};
  std::function<void(const wire::FrameResult&)> on_event{};
  // Somebody who watches asks for it; `wishes` decides.
  std::function<void(bool paused)> on_pause_request{};
};

struct ScanOutcome {
  std::optional<StreamOutcome> stream;  // std::nullopt: only recorded
  ScanProgress progress;                // at the end
};

// Blocks until the result has arrived. kDevice, kNotFound: the camera provides no frames. kIo and
// other errors of stream_frames: no result; a recording is complete all the same, unless the disk
// is full.
Result<ScanOutcome> run_scan(CaptureCamera& camera, const ScanRequest& request,
                             const ScanObserver& observer);

}  // namespace hermite::client
