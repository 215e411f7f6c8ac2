// Who does jobs: this process (local_executor.h) or, some day, an engine that places them on other machines. What every implementation
// keeps is in tests/server/jobs/executor_contract.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/store/job_row.h"

namespace hermite {

// What a running job is at. A job that does not run has no stage.
struct JobStage {
  std::string name;  // "unpacking", "waiting for a free place", "reading the frame log", "tracking", "finishing"
  std::int64_t done = 0;
  std::int64_t total = 0;  // 0: not known
};

struct JobStatus {
  JobRow row;
  JobStage stage;
};

// Belongs to the network thread. Failures of where jobs are kept are kIo.
class Executor {
 public:
  virtual ~Executor() = default;

  // Takes a job with state kQueued. The id is its key: a job that waits, runs or has finished is not done a second time, one that has
  // failed or was cancelled is tried again as it was first submitted. What is submitted survives the server and ends once, well or not.
  // kBusy: too many wait.
  virtual Status submit(const JobRow& job) = 0;

  virtual Result<JobStatus> status(const std::string& id) = 0;  // kNotFound

  // The job is cancelled from here on, whatever becomes of the work; so is one that has failed: somebody has seen it. kNotFound; kBusy: it
  // has finished or was cancelled already.
  virtual Status cancel(const std::string& id) = 0;

  virtual Result<std::vector<JobStatus>> list() = 0;                    // newest first, at most kMaxListedJobs
  virtual Result<std::vector<JobLine>> log(const std::string& id) = 0;  // kNotFound
};

}  // namespace hermite
