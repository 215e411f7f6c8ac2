// The interface of whatever runs jobs: this process (local_executor.h), or another implementation
// that uses other machines. The contract of every implementation is
// tests/server/jobs/executor_contract.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/store/job_row.h"

namespace hermite::server {

// The stage of a running job; other jobs have none.
struct JobStage {
  // "unpacking", "waiting for a free place", "reading the frame log", "tracking", "finishing"; with
  // a cluster also "submitting", "waiting for the cluster", "waiting in the cluster", "starting".
  std::string name;
  std::int64_t done = 0;
  std::int64_t total = 0;  // 0: not known
};

struct JobStatus {
  JobRow row;
  JobStage stage;
};

// Belongs to the network thread. Errors of the job storage are kIo.
class Executor {
 public:
  virtual ~Executor() = default;

  // Submits a job with state kQueued. The id is its key: a job that is queued, running or finished
  // is not run again; one that failed or was cancelled is tried again as it was first submitted. A
  // submitted job survives the server and ends exactly once. kBusy: too many are queued.
  virtual Status submit(const JobRow& job) = 0;

  virtual Result<JobStatus> status(const std::string& id) = 0;  // kNotFound

  // Cancels the job immediately, even if its work takes a while to stop. Also dismisses a failed
  // job. kNotFound; kBusy: it has finished or was cancelled already.
  virtual Status cancel(const std::string& id) = 0;

  // Newest first, at most kMaxListedJobs.
  virtual Result<std::vector<JobStatus>> list() = 0;
  virtual Result<std::vector<JobLine>> log(const std::string& id) = 0;  // kNotFound
};

}  // namespace hermite::server
