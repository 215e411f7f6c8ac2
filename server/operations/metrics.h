// What /metrics tells, in Prometheus' text format. No label holds an id, an address or anything else that a client chooses. Any thread.
//
// Counters and histograms are told of events as they happen; what is known only at a moment (Load) is told when the text is made.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/timeline.h"

namespace hermite {

// Of the whole server.
struct Load {
  std::map<std::string, int> scans;  // running, by mode: "live", "batch"
  std::map<std::string, int> jobs;   // remembered, by state: "queued", "running", "finished", "failed", "cancelled"
  int waiting_cameras = 0;           // for a place
  int viewers = 0;
  std::uint64_t frames_received = 0, frames_processed = 0, frames_dropped = 0;  // since the start
  std::uint64_t credits = 0;                                                    // frames that cameras may send now
  std::uint64_t queue_bytes = 0;                                                // of frames that wait for their worker
  std::uint64_t gpu_memory_bytes = 0;                                           // of running scans
  std::uint64_t gpu_memory_limit_bytes = 0;                                     // for all of them; 0: nobody knows
  std::uint64_t scan_gpu_memory_bytes = 0;                                      // that a scan comes to; 0: none was seen yet
  std::uint64_t disk_free_bytes = 0;                                            // for the data folder
  int connections = 0;
  bool draining = false;
  bool database_damaged = false;
};

class Metrics {
 public:
  explicit Metrics(const std::string& version);
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  // `lost`: this is the frame in which the camera was lost. `latency_s`: from the network to the result.
  void frame_done(const std::vector<Timeline::Stage>& stages, double latency_s, bool unreadable, bool lost);
  void stage_done(const Timeline::Stage& stage);
  // A piece of a live surface. `delay_s`: from the arrival of the first frame with a change that it shows until it is ready to be sent.
  void mesh_made(const Timeline::Stage& work, double delay_s);
  void chunks_encoded(std::uint64_t bytes);
  void scan_ended(const char* phase);
  // After a start of the server, with so many frames from its checkpoint (0: none could be used) and so many that are worked through again.
  void scan_rebuilt(std::uint64_t checkpoint_frames, std::uint64_t replayed_frames);
  // `route` as in the table of routes, never as a client wrote it.
  void request_answered(std::string_view route, int status, double duration_s);
  // `code`: what this server closed with, 1006 where the other side did.
  void websocket_closed(int code);
  void authentication_failed();

  std::string text(const Load& load);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite
