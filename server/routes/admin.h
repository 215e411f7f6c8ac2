// The routes of the admin address, for monitoring and for operators. It requires no token, so it
// listens on the loopback address. On the network thread.
//
//   GET /healthz             "ok": the event loop runs
//   GET /readyz              200 "ready", or 503 and one line per reason: draining, the database,
//                            the disk, S3, the GPU
//   GET /metrics             text format of Prometheus
//   GET /debug/trace?scan=ID the last minute of a scan's frames for chrome://tracing
#pragma once

#include <chrono>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/pipeline/doctor.h"
#include "server/access/rate_limit.h"
#include "server/disk/store_watch.h"
#include "server/operations/metrics.h"
#include "server/routes/http_routes.h"
#include "server/scan/scans.h"
#include "server/store/store.h"

namespace hermite::server {

// Watches whether the GPU can be opened: tries it on a separate thread when the server starts, and
// again while the last try or the last scan has failed.
class DeviceWatch {
 public:
  explicit DeviceWatch(std::string device);

  // Returns what is wrong, as text; std::nullopt if nothing is. Starts another try when one is due.
  // Never blocks.
  std::optional<std::string> problem(bool scan_failed);

 private:
  void start();

  const std::string device_;
  std::chrono::steady_clock::time_point started_;
  std::optional<Result<pipeline::OpenedDevice>> known_;
  std::future<Result<pipeline::OpenedDevice>> trying_;
};

struct AdminWorld {
  Scans& scans;
  Store& store;
  Metrics& metrics;
  DeviceWatch& device;
  const StoreWatch& store_watch;
  const std::string& data_folder;
  std::uint64_t min_free_bytes = 0;
  const CountLimit& connections;
  const bool& draining;
};

// Returns why the server should not get new work, as text; empty if it is ready.
std::vector<std::string> reasons_not_ready(const AdminWorld& world);

HttpAnswer answer_admin(const AdminWorld& world, const HttpRequest& request);

}  // namespace hermite::server
