// A real server on a free port, on a thread of this process. Header only.
#pragma once

#include <string>
#include <thread>

#include "server/service/service.h"

namespace hermite::test {

inline server::ServiceOptions test_options(const std::string& data_folder) {
  server::ServiceOptions options;
  options.listen = "127.0.0.1:0";
  options.admin_listen = "off";
  options.data_folder = data_folder;
  options.stop_on_signals = false;
  options.min_free_disk_mb = 0;
  options.mesh_on_demand = true;  // tests that look at meshes ask for them
  // All tests come from one address and are quicker than people; tests of limits set their own.
  options.max_connections = options.connections_per_address = options.connections_per_token =
      options.requests_per_second = 10'000;
  return options;
}

class RunningServer {
 public:
  explicit RunningServer(const server::ServiceOptions& options)
      : service_(options), thread_([this] { ended_in_time_ = service_.run(); }) {}
  ~RunningServer() { stop(); }
  RunningServer(const RunningServer&) = delete;
  RunningServer& operator=(const RunningServer&) = delete;

  // Waits for the end; whether all scans ended in time.
  bool stop() {
    if (thread_.joinable()) {
      service_.stop();
      thread_.join();
    }
    return ended_in_time_;
  }

  server::Service& service() { return service_; }
  int port() const { return std::stoi(service_.url().substr(service_.url().rfind(':') + 1)); }
  const std::string& token() const { return service_.token(); }

 private:
  server::Service service_;
  bool ended_in_time_ = false;
  std::thread thread_;
};

}  // namespace hermite::test
