// What the camera and the viewers of a running scan are shown of it: its state with the message to
// its users, the map as it grows, and how far viewers are behind. Belongs to the network thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "proto/wire/messages.h"
#include "server/scan/arrivals.h"
#include "server/scan/received_frames.h"
#include "server/scan/scan_camera.h"
#include "server/scan/scan_lifecycle.h"
#include "server/scan/scan_worker.h"
#include "server/scan/subscribers.h"

namespace hermite::server {

class LiveDisplay {
 public:
  // What the shown state is made of. All of it, and the subscribers, outlive the display.
  struct Scan {
    const ReceivedFrames& frames;
    const ScanLifecycle& lifecycle;
    ScanCamera& camera;
  };
  LiveDisplay(const Scan& scan, Subscribers& subscribers);
  LiveDisplay(const LiveDisplay&) = delete;
  LiveDisplay& operator=(const LiveDisplay&) = delete;

  // Shows the present state to camera and viewers.
  void show_state();
  // The same while a camera is being attached: it has not been greeted yet, and is sent no state.
  void show_state_to_viewers();

  // Shown until replaced, to camera and viewers; empty: nothing. What the camera does comes before
  // what the worker says, and that before the warning.
  void warn(const std::string& message);
  void worker_says(const std::string& message);

  // Events of the worker. LiveScan has counted the frames of restored() and frame_done(), and tells
  // the camera itself.
  void restored(RestoredScan restored);
  void frame_done(const FrameOutcome& outcome);
  void model_changed(ModelUpdate update);
  void mesh_changed(MeshUpdate update);

  // The scan is over: shows viewers the last state, which is returned, and lets them go when they
  // have everything.
  wire::ScanState close(const std::string& message);

  const Arrivals& arrivals() const { return arrivals_; }
  std::uint64_t gpu_memory_bytes() const { return gpu_memory_bytes_; }  // of the scan

 private:
  wire::ScanState state(const std::string& message) const;
  std::string message() const;

  const Scan scan_;
  Subscribers& subscribers_;
  // From the last update of the model.
  std::uint64_t keyframes_ = 0, loops_ = 0, gpu_memory_bytes_ = 0;
  std::optional<UpDirection> up_;
  std::string warning_;
  std::string worker_message_;
  bool mesh_ended_ = false;
  Arrivals arrivals_;
};

}  // namespace hermite::server
