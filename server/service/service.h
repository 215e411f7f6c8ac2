// The server: one network thread, which is the one that calls run(), and a worker thread for each
// running scan.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite::server {

// Options with their meanings and defaults. Names, units and limits are in settings_table.h, from
// which `hermite serve` takes all of them.
struct ServiceOptions {
  std::string listen = "127.0.0.1:8080";        // port 0: any free one
  std::string admin_listen = "127.0.0.1:9464";  // health, metrics, traces; "off": none
  std::string data_folder;
  // Where rows are: "postgresql://…"; empty: in data_folder, or where that says.
  std::string database;
  std::string blobs;        // where results are: "s3://BUCKET/PREFIX"; empty: in data_folder
  std::string s3_endpoint;  // "https://HOST:PORT"; empty: Amazon's
  std::string s3_region = "us-east-1";
  std::string s3_addressing = "path";  // path or virtual-host
  std::string s3_ca;                   // PEM file; empty: the system's certificates
  std::string s3_credentials;          // file with the key; empty: in the environment
  std::string web_folder;              // the viewer's files
  std::string device;                  // as for Pipeline
  // Additional names in Host and Origin headers, besides those of the loopback address.
  std::vector<std::string> allow_hosts;
  std::vector<std::string> embed_in;  // sites whose pages may show scans in a frame
  // Addresses or networks whose X-Forwarded- headers are trusted.
  std::vector<std::string> trusted_proxies;
  std::string tls_certificate, tls_key;  // PEM files, both or none
  int max_scans = 4;                     // running at once; others wait in the queue
  int live_rate_hz = 5;                  // PlaceRules
  int credit_window = 16;                // frames
  int gpu_memory_mb = 0;                 // for all scans; 0: no limit but the device's
  int resume_window_s = 120;             // how long a scan waits for its lost camera
  // How long a camera that may send a frame may send none.
  int frame_patience_s = 120;
  int checkpoint_period_ms = 30'000;  // of running scans; 0: none
  int keep_log_days = 7;              // frames of an ended scan; 0: for ever
  int drain_s = 20;                   // time for running scans to finish after SIGTERM
  // With less, the server is not ready, and scans do not continue.
  int min_free_disk_mb = 1024;
  int max_connections = 256;         // open at once
  int connections_per_address = 64;  // open at once, per address
  int connections_per_token = 64;    // WebSockets per token without the scope admin
  // HTTP requests per address, and per token; bursts of twice as many.
  int requests_per_second = 60;
  int failures_per_minute = 5;  // wrong tokens per address
  // Running at once; tokens with the scope admin have only the server's limit.
  int scans_per_token = 2;
  // Space for the files of all scans and uploads; 0: no limit but the disk's.
  int storage_gb = 0;
  int job_workers = 1;  // jobs that run at once; each takes one of max_scans
  // Who does the jobs of recordings: "local", this process, or "slurm", a cluster (server/slurm).
  std::string batch = "local";
  std::string slurm_folder;                  // that all nodes share; empty: data_folder/slurm
  std::string slurm_program;                 // hermite on the nodes; empty: this program's own path
  std::string slurm_partition;               // empty: the cluster's default
  std::vector<std::string> slurm_arguments;  // more arguments of sbatch
  int slurm_jobs = 16;                       // in the cluster at once
  int slurm_time_limit_min = 0;              // 0: that of the partition
  int slurm_memory_mb = 0;                   // of a job; 0: from what earlier jobs have taken
  int max_upload_gb = 20;                    // per upload
  // All stored uploads of one token; 0: no limit but the disk's.
  int uploads_per_token_gb = 20;
  int keep_upload_hours = 24;  // after it was last used
  // Make the mesh of a scan on request instead of when the scan has finished.
  bool mesh_on_demand = false;
  std::string log_format = "auto";  // auto, json or text
  std::string log_level = "info";   // debug, info, warn or error
  bool insecure_listen = false;     // allow other addresses than loopback ones without TLS
  int slurm_poll_ms = 2000;         // how often the cluster is asked. Not a setting.
  // SIGINT, SIGTERM; SIGHUP reloads the certificate. Not a setting.
  bool stop_on_signals = true;
};

class Service {
 public:
  // Opens data folder, store, viewer files and port. Throws SetupError, with a message.
  explicit Service(const ServiceOptions& options);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  const std::string& url() const;    // "http://127.0.0.1:8080", with the actual port
  const std::string& token() const;  // the first token
  bool token_works() const;          // not revoked
  int admin_port() const;            // 0: no admin address

  // Blocks until stop() or a signal, then until running scans have written what they have; after
  // SIGTERM they may continue for drain_s first. Returns false if one of them did not end in time
  // and its thread is still busy: then end the process without destroying the service.
  bool run();

  // May be called on any thread.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite::server
