// The server: one network thread, which is the one that calls run(), and a worker thread for each running scan.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite {

// Defaults and meaning; names, units and limits are in settings.cpp, which `hermite serve` takes all of them from.
struct ServiceOptions {
  std::string listen = "127.0.0.1:8080";        // port 0: any free one
  std::string admin_listen = "127.0.0.1:9464";  // health, metrics, traces; "off": none
  std::string data_folder;
  std::string web_folder;                    // the viewer's files
  std::string device;                        // as for Pipeline
  std::vector<std::string> allow_hosts;      // names in Host and Origin headers besides the loopback's
  std::vector<std::string> trusted_proxies;  // addresses or networks whose X-Forwarded- headers are believed
  std::string tls_certificate, tls_key;      // PEM files, both or none
  int max_scans = 4;                         // running at once; others wait
  int live_rate_hz = 5;                      // PlaceRules
  int credit_window = 16;                    // frames
  int gpu_memory_mb = 0;                     // for all scans, 0: as much as there is
  int resume_window_s = 120;                 // so long a scan waits for its lost camera
  int frame_patience_s = 120;                // so long a camera that could send a frame may send none
  int checkpoint_period_ms = 30'000;         // of running scans, 0: none
  int keep_log_days = 7;                     // frames of an ended scan; 0: for ever
  int drain_s = 20;                          // that running scans get to finish after SIGTERM
  int min_free_disk_mb = 1024;               // with less the server is not ready, and no scan goes on
  int max_connections = 256;                 // open at once
  int connections_per_address = 64;          // the same of one address
  int connections_per_token = 64;            // WebSockets of one token that may not administer
  int requests_per_second = 60;              // HTTP requests of an address, and of a token; twice as many at once
  int failures_per_minute = 5;               // wrong tokens of an address
  int scans_per_token = 2;                   // running at once; tokens that may administer have only the server's limit
  int storage_gb = 0;                        // for the files of all scans and uploads, 0: as much as there is
  int job_workers = 1;                       // jobs at once; each has one of max_scans
  int max_upload_gb = 20;                    // one upload
  int uploads_per_token_gb = 20;             // all uploads of one token that are kept, 0: as much as there is
  int keep_upload_hours = 24;                // after something has happened with it
  bool mesh_on_demand = false;               // the mesh of a scan is made when it is asked for, not when the scan has finished
  std::string log_format = "auto";           // auto, json or text
  std::string log_level = "info";            // debug, info, warn or error
  bool insecure_listen = false;              // allow other addresses than the loopback's, without TLS
  bool stop_on_signals = true;               // SIGINT, SIGTERM; SIGHUP reads the certificate again. No setting.
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
  int admin_port() const;            // 0: there is no admin address

  // Blocks until stop() or a signal, then until running scans have written what they have: after SIGTERM they may go on for drain_s first.
  // False: one of them did not end in time, and its thread is still busy: then end the process without destroying the service.
  bool run();

  // From any thread.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite
