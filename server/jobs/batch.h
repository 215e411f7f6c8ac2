// Batch processing: uploads become jobs, and jobs become scans. Belongs to the network thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

#include "server/disk/log_readers.h"
#include "server/disk/storage.h"
#include "server/jobs/local_executor.h"
#include "server/jobs/scan_job.h"
#include "server/scan/scans.h"
#include "server/uploads/uploads.h"

namespace hermite::server {

// Recovers the jobs of a server that died, and their scans. Called before Scans exists. kIo.
Status recover_batch(const Storage& storage);

class Batch {
 public:
  // The members of `storage`, and `scans`, outlive this. Throws SetupError.
  Batch(int worker_count, const UploadLimits& limits, const Storage& storage, Scans& scans,
        const LogReaders::Post& post);

  Uploads& uploads() { return uploads_; }
  Executor& executor() { return executor_; }

  // Called periodically.
  void tick(std::chrono::steady_clock::time_point now, std::int64_t retention_now_ms);
  void refuse_new() { executor_.refuse_new(); }
  void stop() { executor_.stop(); }  // call before Scans::stop()
  std::size_t running_count() const { return executor_.running_count(); }

 private:
  LocalExecutor::Hooks executor_hooks(const LogReaders::Post& post);
  Status submit(const UploadRow& row);
  void job_ended(const JobRow& row);

  Store& store_;
  Scans& scans_;
  const ScanJobWorld job_world_;
  LocalExecutor executor_;
  Uploads uploads_;
  std::chrono::steady_clock::time_point sweep_at_{};  // at the first tick
};

}  // namespace hermite::server
