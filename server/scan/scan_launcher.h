// Starts scans, new ones and those that go on from their log: the folder, log and row of a new
// scan, its worker, and the way of the worker's events to the network thread. Belongs to the
// network thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/access/places.h"
#include "server/disk/log_readers.h"
#include "server/disk/storage.h"
#include "server/operations/frame_traces.h"
#include "server/operations/metrics.h"
#include "server/scan/live_scan.h"
#include "server/scan/scan_record.h"
#include "server/scan/scan_rows.h"

namespace hermite::server {

// The most encoded bytes that one scan may queue. With 2048 x 2048 pixels this allows a window of 3
// frames.
inline constexpr std::size_t kMaxQueuedBytes = 128 * 1024 * 1024;

struct ScansOptions {
  std::string device;  // as for Pipeline
  PlaceRules places;
  std::uint32_t credit_window = 16;  // frames, at most
  // Memory of all scans together, in equal shares; 0: all there is.
  int gpu_memory_mb = 0;
  std::chrono::milliseconds resume_window{120'000};  // how long a scan waits for its lost camera
  // How long a camera with credit may send nothing.
  std::chrono::milliseconds frame_patience{120'000};
  // Free bytes that scans must leave, besides room for their results.
  std::uint64_t min_free_disk_bytes = 0;
  int keep_log_days = 7;                           // after the end of the scan; 0: for ever
  std::chrono::milliseconds checkpoint_period{0};  // of running scans; 0: none
};

// A scan that is being started. Its worker and log refer to it through `self`.
struct Launch {
  ScanRow row;
  ScanRecord record;
  pipeline::Options options;
  PlaceRequest place;
  std::shared_ptr<std::weak_ptr<LiveScan>> self = std::make_shared<std::weak_ptr<LiveScan>>();
};

class ScanLauncher {
 public:
  // What the launcher changes besides the storage, and whom it tells.
  struct World {
    Places& places;
    ScanRows& rows;
    RunningScans& running;
    Metrics& metrics;
    LogReaders::Post post;  // to the network thread
    // Called on the network thread by the scan itself.
    std::function<void(const ScanRow& started, const ScanEnd&)> ended;
  };
  // Everything that the arguments refer to outlives this.
  ScanLauncher(const ScansOptions& options, const Storage& storage, World world);

  // Returns the launch of a requested scan. kInvalidArgument: a setting in the request is wrong.
  Result<Launch> launch_of(const std::string& scan_id, const wire::StartScan& request,
                           const std::string& resume_token, const ScanOwner& owner,
                           const PlaceRequest& place) const;

  // Starts a new scan. kIo: the store or the disk; nothing is left of it then.
  Result<std::shared_ptr<LiveScan>> begin(const Launch& launch);

  // Runs a scan whose folder, log and row exist.
  std::shared_ptr<LiveScan> run(const Launch& launch, frame_log::FrameLog::Opened opened);

  frame_log::FrameLogEvents log_events(const Launch& launch) const;

  // A camera may request a smaller limit than the server's, not a larger one.
  std::chrono::milliseconds frame_patience_of(const wire::StartScan& request) const;

  const FrameTraces& traces() const { return traces_; }

 private:
  template <class Tell>
  void deliver(const Launch& launch, Tell tell) const;
  ScanEvents worker_events(const Launch& launch, const ScanPast& past);

  const ScansOptions& options_;
  const Storage storage_;
  const World world_;
  FrameTraces traces_;
};

}  // namespace hermite::server
