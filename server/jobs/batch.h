// Batch processing: uploads become jobs, and jobs become scans. Belongs to the network thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "server/disk/log_readers.h"
#include "server/disk/storage.h"
#include "server/jobs/local_executor.h"
#include "server/jobs/scan_job.h"
#include "server/scan/scans.h"
#include "server/uploads/uploads.h"

namespace hermite::server {

// Other machines that do the jobs of recordings instead of this process (server/slurm). Called on
// the network thread.
struct OtherMachines {
  int job_count = 0;  // that they are given at once
  std::function<std::unique_ptr<JobWork>(const ScanJobWorld&, const JobRow&, JobEvents)> start;
  std::function<void(const std::string& job_id)> ended;  // it will not be tried again
};

struct BatchOptions {
  int worker_count = 1;  // jobs that this process does at once
  UploadLimits uploads;
  std::optional<OtherMachines> others;  // then this process only does imports
};

// Recovers the jobs of a server that died, and their scans. Called before Scans exists.
// `goes_on_elsewhere`: as in JobScans. kIo.
Status recover_batch(const Storage& storage,
                     std::function<bool(const JobRow&)> goes_on_elsewhere = {});

class Batch {
 public:
  // The members of `storage`, and `scans`, outlive this. Throws SetupError.
  Batch(BatchOptions options, const Storage& storage, Scans& scans, const LogReaders::Post& post);

  Uploads& uploads() { return uploads_; }
  Executor& executor() { return executor_; }

  // Called periodically.
  void tick(std::chrono::steady_clock::time_point now, std::int64_t retention_now_ms);
  void refuse_new() { executor_.refuse_new(); }
  void stop() { executor_.stop(); }  // call before Scans::stop()
  std::size_t running_count() const { return executor_.running_count(); }

 private:
  LocalExecutor::Hooks executor_hooks(const LogReaders::Post& post);
  std::unique_ptr<JobWork> start(const JobRow& row, JobEvents events);
  bool is_import_job(const JobRow& row);
  bool has_room(const JobRow& row);
  Status submit(const UploadRow& row);
  void job_ended(const JobRow& row);

  const BatchOptions options_;
  Store& store_;
  Scans& scans_;
  const ScanJobWorld job_world_;
  LocalExecutor executor_;
  Uploads uploads_;
  std::map<std::string, bool> is_import_;             // by the id of a job that has not ended
  std::chrono::steady_clock::time_point sweep_at_{};  // at the first tick
};

}  // namespace hermite::server
