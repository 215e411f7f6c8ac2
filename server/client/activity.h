// What a server is doing: the scans that run, the jobs that have not ended and, where its metrics
// can be read, its load.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/client/scans.h"
#include "server/client/upload.h"

namespace hermite::client {

struct RunningScan {
  ScanSummary scan;
  std::int64_t waiting_frames = 0;     // received and neither processed nor dropped
  std::optional<double> frames_per_s;  // processed since the last reading; nullopt: not read before
};

struct ServerLoad {
  std::int64_t viewers = 0;
  std::int64_t waiting_cameras = 0;   // for a place
  double gpu_memory_bytes = 0;        // of running scans
  double gpu_memory_limit_bytes = 0;  // 0: unknown
  double disk_free_bytes = 0;
  bool is_draining = false, is_database_damaged = false;
  // Mean time from a frame's arrival to its result; nullopt: no frame since the last reading.
  std::optional<double> latency_s;
};

struct Activity {
  std::vector<RunningScan> scans;              // newest first
  std::optional<std::vector<JobReport>> jobs;  // newest first; nullopt: the token may not see jobs
  std::optional<ServerLoad> load;              // nullopt: nobody asked for the metrics
};

// Returns the metrics without labels, by name, of a text in the format of Prometheus. Lines that
// cannot be read are left out.
std::map<std::string, double> metric_values(const std::string& text);

// One thread at a time.
class ActivityReader {
 public:
  // `metrics`: the address of the server's own metrics, if they are to be read.
  ActivityReader(ApiTarget target, std::optional<ServerUrl> metrics);

  // Asks the server and blocks until it has answered. The first reading lists all scans, the
  // following ones the newest thousand and those that were running. Errors as list_scans().
  Result<Activity> read();

 private:
  using Clock = std::chrono::steady_clock;
  struct Counted {
    Clock::time_point at;
    std::int64_t frames = 0;
  };
  Result<std::vector<ScanSummary>> running_scans();
  Result<ServerLoad> load();

  const ApiTarget target_;
  const std::optional<ServerUrl> metrics_;
  std::map<std::string, Counted> counted_;  // of the scans that were running, by id
  bool has_read_ = false;
  std::map<std::string, double> last_metrics_;
};

}  // namespace hermite::client
