// The metrics at /metrics, in the text format of Prometheus. No label contains an id, an address or
// anything else that a client chooses. Any thread.
//
// Counters and histograms are updated when events happen; momentary values (Load) are passed when
// the text is made.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/timeline.h"

namespace hermite::server {

// The current state of the whole server.
struct Load {
  std::map<std::string, int> scans;  // running, by mode: "live", "batch"
  // Stored, by state: "queued", "running", "finished", "failed", "cancelled".
  std::map<std::string, int> jobs;
  int waiting_cameras = 0;  // cameras in the queue
  int viewers = 0;
  std::uint64_t frames_received = 0, frames_processed = 0, frames_dropped = 0;  // since the start
  // Frames that cameras may send at the moment.
  std::uint64_t credits = 0;
  // Bytes of frames that wait for their worker.
  std::uint64_t queue_bytes = 0;
  std::uint64_t gpu_memory_bytes = 0;  // of running scans
  // Limit for all of them; 0: unknown.
  std::uint64_t gpu_memory_limit_bytes = 0;
  // Expected for a scan; 0: not measured yet.
  std::uint64_t scan_gpu_memory_bytes = 0;
  // Free bytes for the data folder.
  std::uint64_t disk_free_bytes = 0;
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

  // `lost`: tracking was lost in this frame. `latency_s`: from its arrival to its result.
  void frame_done(const std::vector<Timeline::Stage>& stages, double latency_s, bool unreadable,
                  bool lost);
  void stage_done(const Timeline::Stage& stage);
  // A piece of a live surface. `delay_s`: from the arrival of the first frame with a change in it
  // until it is ready to be sent.
  void mesh_made(const Timeline::Stage& work, double delay_s);
  void chunks_encoded(std::uint64_t bytes);
  void scan_ended(const char* phase);
  // A scan resumed after a restart of the server, with how many frames from its checkpoint (0: no
  // usable one), and how many that are processed again.
  void scan_rebuilt(std::uint64_t checkpoint_frames, std::uint64_t replayed_frames);
  // `route` as in the table of routes, never as sent by a client.
  void request_answered(std::string_view route, int status, double duration_s);
  // `code`: the close code sent by this server; 1006 if the other side closed.
  void websocket_closed(int code);
  void authentication_failed();

  std::string text(const Load& load);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite::server
