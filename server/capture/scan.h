// One scan with an attached camera: a look at its first frames, then frames to the server until somebody says enough, then the result.
//
// Without a recording the newest frame counts (live): what link or server cannot take is dropped, and counted. With one every frame is
// written to a local log and sent from there, in order, none left out (batch): while the server is away the camera goes on, and what it
// missed follows. When the server has given up the scan meanwhile, all of the log is sent again as a new one.
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

namespace hermite {

struct ScanRequest {
  std::optional<StreamRequest> stream{};  // none: only recorded. Its pacing does not matter
  std::string title{};
  std::string record_folder{};                         // new; empty: no recording (CHECKs that there is a stream)
  std::uint64_t max_frames = 0;                        // 0: until an interrupt, or the camera's end
  int preflight_frames = kPreflightFrames;             // kMin to kMaxPreflightFrames (CHECK); these are not part of the scan
  std::chrono::milliseconds camera_patience{10'000};   // for each of the first frames
  std::chrono::milliseconds server_patience{600'000};  // when all is recorded, for a server that is away
};

inline constexpr int kMinPreflightFrames = 3;   // the depth codec is chosen by them
inline constexpr int kMaxPreflightFrames = 90;  // they are held in memory: 1.5 MB each at 640x480

struct ScanProgress {
  StreamProgress stream;  // of the connection that there is, or was last
  CaptureState capture;
  std::optional<LocalLog::State> log;
  std::uint64_t dropped_frames = 0;  // by camera, computer, link and server
};

// Each may be empty. All but `wishes` are called on the thread of run_scan.
struct ScanObserver {
  std::function<CaptureWishes()> wishes{};                   // as Capture::Events: first on this thread, then on another
  std::function<void(const ScanProgress&)> on_progress{};    // several times a second
  std::function<void(const std::string& words)> on_words{};  // the pre-flight's, of the link, of single frames
  std::function<void(const wire::FrameResult&)> on_event{};
};

struct ScanOutcome {
  std::optional<StreamOutcome> stream;  // none: only recorded
  ScanProgress progress;                // at the end
};

// Blocks until the result is here. kDevice, kNotFound: the camera gives nothing. kIo and what stream_frames says otherwise: no result; a
// recording is whole all the same, up to the end of the disk.
Result<ScanOutcome> run_scan(CaptureCamera& camera, const ScanRequest& request, const ScanObserver& observer);

}  // namespace hermite
