// The server: one network thread, which is the one that calls run(), and a worker thread for each running scan.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/service/limits.h"

namespace hermite {

struct ServiceOptions {
  std::string listen = "127.0.0.1:8080";  // port 0: any free one
  std::string data_folder;
  std::string web_folder;                // the viewer's files
  std::string device;                    // as for Pipeline
  std::vector<std::string> allow_hosts;  // names in Host and Origin headers besides the loopback's
  int max_scans = 4;                     // running at once, 1 to 64
  int credit_window = 16;                // frames, 1 to 256
  int gpu_memory_mb = 0;                 // for all scans, 0: as much as there is
  bool insecure_listen = false;          // allow other addresses than the loopback's, without TLS
  bool stop_on_signals = true;           // SIGINT, SIGTERM
  Limits limits;
};

class Service {
 public:
  // Opens data folder, store, viewer files and port. Throws SetupError in words.
  explicit Service(const ServiceOptions& options);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  const std::string& url() const;    // "http://127.0.0.1:8080", with the real port
  const std::string& token() const;  // the first token
  bool token_works() const;          // not revoked

  // Blocks until stop() or a signal, then until running scans have written what they have. False: one of them did not end in time, and its
  // thread is still busy: then end the process without destroying the service.
  bool run();

  // From any thread.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite
