// What the admin address answers: for monitoring and for people who look after the server. It asks for no token, so it listens on the
// loopback address. On the network thread.
//
//   GET /healthz             "ok": the event loop answers
//   GET /readyz              200 "ready", or 503 and a line for each reason: draining, the database, the disk, the GPU
//   GET /metrics             Prometheus' text format
//   GET /debug/trace?scan=ID the last minute of a scan's frames for chrome://tracing
#pragma once

#include <chrono>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/access/rate_limit.h"
#include "server/disk/store_watch.h"
#include "server/operations/metrics.h"
#include "server/routes/http_routes.h"
#include "server/scan/scans.h"
#include "server/store/store.h"

namespace hermite {

// Whether the GPU can be opened: tried on a thread of its own when the server starts, and again while the last try or the last scan has
// failed.
class DeviceWatch {
 public:
  explicit DeviceWatch(std::string device);

  // What is wrong, in words; nothing when all is well. Starts another try when it is time. Never blocks.
  std::optional<std::string> problem(bool scan_failed);

 private:
  void start();

  const std::string device_;
  std::chrono::steady_clock::time_point started_;
  std::optional<Result<std::string>> known_;
  std::future<Result<std::string>> trying_;
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

// Why the server should get no new work, in words; none when it is ready.
std::vector<std::string> reasons_not_ready(const AdminWorld& world);

HttpAnswer answer_admin(const AdminWorld& world, const HttpRequest& request);

}  // namespace hermite
