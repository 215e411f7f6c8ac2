#include "server/service/settings_table.h"

#include <utility>

namespace hermite::server {

namespace {

// Where the server listens, and where its own files are.
std::vector<SettingRow> rows_of_addresses() {
  using O = ServiceOptions;
  return {
      {"listen", &O::listen, "IP:PORT for cameras and browsers; port 0 takes any free one"},
      {"admin-listen", &O::admin_listen,
       "IP:PORT for /healthz, /readyz, /metrics and /debug/trace, without a token; off: none"},
      {"data", &O::data_folder, "folder for scans, database and token"},
      {"web-dir", &O::web_folder, "the viewer's files"},
  };
}

// How scans are run, and how long their frames are kept.
std::vector<SettingRow> rows_of_scans() {
  using O = ServiceOptions;
  return {
      {"device", &O::device, "GPU: an index or a part of its name; empty: the best one"},
      {"gpu-memory", &O::gpu_memory_mb,
       "device memory for all scans together, an equal share each; 0: as much as there is", 0,
       1'000'000, "MB"},
      {"max-scans", &O::max_scans, "scans running at once", 1, 64, "scans"},
      {"live-rate", &O::live_rate_hz,
       "frames a second that a live scan gets at least: while it runs, others wait if it would "
       "get fewer; 0: do not ask",
       0, 60, "frames/s"},
      {"credit-window", &O::credit_window, "frames a camera may send ahead of the reconstruction",
       1, 256, "frames"},
      {"resume-window", &O::resume_window_s,
       "how long a scan waits for its camera when the connection is lost", 0, 86'400, "s"},
      {"frame-patience", &O::frame_patience_s,
       "how long a camera that could send a frame may send none before it loses its place", 1,
       86'400, "s"},
      {"checkpoint-period", &O::checkpoint_period_ms,
       "how often a running scan is stored, so that a restart works through fewer frames "
       "again; 0: never",
       0, 3'600'000, "ms"},
      {"keep-logs", &O::keep_log_days, "how long the frames of an ended scan are kept; 0: for ever",
       0, 36'500, "days"},
  };
}

// By which names, from which pages and how well encrypted the server is reached.
std::vector<SettingRow> rows_of_encryption() {
  using O = ServiceOptions;
  return {
      {"allow-host", &O::allow_hosts, "other names that this server is reached by"},
      {"embed-in", &O::embed_in,
       "sites whose pages may show scans in a frame, as https://example.org or "
       "https://*.example.org; *: any; none: no page may"},
      {"tls-certificate", &O::tls_certificate,
       "certificate and its chain, PEM; read again on SIGHUP; empty: no TLS"},
      {"tls-key", &O::tls_key, "its private key, PEM"},
      {"trusted-proxy", &O::trusted_proxies,
       "addresses or networks (10.0.0.0/8) of proxies that end TLS; X-Forwarded-For and -Proto "
       "are believed from these alone"},
      {"insecure-i-know", &O::insecure_listen,
       "listen on other addresses than the loopback's without encryption"},
  };
}

// What there is for all, for an address and for a token; and the end of the server.
std::vector<SettingRow> rows_of_shares() {
  using O = ServiceOptions;
  return {
      {"drain", &O::drain_s,
       "how long running scans may go on after SIGTERM before they are left to the next server", 0,
       86'400, "s"},
      {"min-free-disk", &O::min_free_disk_mb,
       "room that stays free, beside that for results: else no scan begins, those that run "
       "end, and the server is not ready",
       0, 1'000'000'000, "MB"},
      {"max-connections", &O::max_connections, "connections open at once", 1, 10'000,
       "connections"},
      {"connections-per-address", &O::connections_per_address,
       "the same of one address; a trusted proxy's are not held to it", 1, 10'000, "connections"},
      {"connections-per-token", &O::connections_per_token,
       "cameras and viewers of one token without the scope admin", 1, 10'000, "connections"},
      {"requests-per-second", &O::requests_per_second,
       "HTTP requests of one address, and of one token without the scope admin; twice as many "
       "may come at once",
       1, 10'000, "requests"},
      {"failures-per-minute", &O::failures_per_minute,
       "wrong tokens of one address before it has to wait", 1, 1000, "tokens"},
      {"scans-per-token", &O::scans_per_token,
       "scans running at once of one token without the scope admin", 1, 64, "scans"},
      {"storage-gb", &O::storage_gb,
       "for the files of all scans and uploads; when it is used up none begins, and those that "
       "run end; 0: no limit",
       0, 1'000'000, "GB"},
  };
}

// Uploads, and the jobs that are made of them.
std::vector<SettingRow> rows_of_jobs() {
  using O = ServiceOptions;
  return {
      {"job-workers", &O::job_workers, "jobs at once; each needs one of max-scans", 1, 64, "jobs"},
      {"max-upload", &O::max_upload_gb, "one upload", 1, 1'000'000, "GB"},
      {"uploads-per-token", &O::uploads_per_token_gb,
       "all uploads of one token without the scope admin that wait for their job; 0: as much "
       "as there is",
       0, 1'000'000, "GB"},
      {"keep-uploads", &O::keep_upload_hours,
       "how long an upload waits to be gone on with, or for its failed job to be tried again", 1,
       720, "hours"},
      {"mesh-on-demand", &O::mesh_on_demand,
       "make the mesh of a scan when somebody looks at it, and not as soon as it has finished"},
  };
}

// The cluster that jobs are handed to.
std::vector<SettingRow> rows_of_cluster() {
  using O = ServiceOptions;
  return {
      {"batch",
       &O::batch,
       "who does the jobs of recordings: local: this server; slurm: the nodes of a Slurm cluster",
       0,
       0,
       "",
       {"local", "slurm"}},
      {"slurm-folder", &O::slurm_folder,
       "folder that this machine and all nodes have under the same name, for what they exchange; "
       "empty: slurm in the folder of data"},
      {"slurm-program", &O::slurm_program,
       "the program hermite on the nodes; empty: at the same path as here"},
      {"slurm-partition", &O::slurm_partition, "partition for the jobs; empty: Slurm's default"},
      {"slurm-arguments", &O::slurm_arguments,
       "more arguments of sbatch, each with its value: --gres=gpu:1"},
      {"slurm-jobs", &O::slurm_jobs, "jobs in the cluster at once, waiting ones included", 1, 256,
       "jobs"},
      {"slurm-time-limit", &O::slurm_time_limit_min,
       "time that a job asks for; 0: the partition's own", 0, 43'200, "minutes"},
      {"slurm-memory", &O::slurm_memory_mb,
       "memory that a job asks for; 0: half as much again as earlier ones have taken", 0, 1'000'000,
       "MB"},
  };
}

// The lines on stderr.
std::vector<SettingRow> rows_of_logs() {
  using O = ServiceOptions;
  return {
      {"log-format",
       &O::log_format,
       "of the lines on stderr; auto: text on a terminal, else JSON",
       0,
       0,
       "",
       {"auto", "json", "text"}},
      {"log-level",
       &O::log_level,
       "lines below it are left out",
       0,
       0,
       "",
       {"debug", "info", "warn", "error"}},
  };
}

// Where rows and results are, if not in the folder of data.
std::vector<SettingRow> rows_of_places() {
  using O = ServiceOptions;
  return {
      {"database", &O::database,
       "where the rows of scans, tokens and jobs are: postgresql://USER@HOST/DATABASE, or empty: "
       "in the folder of data"},
      {"blobs", &O::blobs,
       "where the results of scans are: s3://BUCKET/PREFIX, or empty: in the folder of data"},
      {"s3-endpoint", &O::s3_endpoint, "https://HOST:PORT of S3; empty: Amazon's of the region"},
      {"s3-region", &O::s3_region, "region of the bucket"},
      {"s3-addressing",
       &O::s3_addressing,
       "path: https://HOST/BUCKET, as most servers have it; virtual-host: https://BUCKET.HOST",
       0,
       0,
       "",
       {"path", "virtual-host"}},
      {"s3-ca", &O::s3_ca, "certificates that S3 is checked with, PEM; empty: the system's"},
      {"s3-credentials", &O::s3_credentials,
       "file, mode 0600, with aws_access_key_id = ... and aws_secret_access_key = ...; empty: "
       "AWS_ACCESS_KEY_ID, ... of the environment"},
  };
}

}  // namespace

const std::vector<SettingRow>& setting_rows() {
  static const std::vector<SettingRow> table = [] {
    std::vector<SettingRow> all;
    for (const auto& rows_of_group :
         {rows_of_addresses, rows_of_scans, rows_of_encryption, rows_of_shares, rows_of_jobs,
          rows_of_cluster, rows_of_logs, rows_of_places})
      for (SettingRow& row : rows_of_group()) all.push_back(std::move(row));
    return all;
  }();
  return table;
}

}  // namespace hermite::server
