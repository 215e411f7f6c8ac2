// The rows of jobs and their lines. Contract and errors: store.h.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/database/database.h"
#include "server/store/job_row.h"

namespace hermite::server {

inline constexpr int kMaxListedJobs = 1000;
inline constexpr int kMaxJobLines = 200;  // per job; further lines are dropped

// Of ended jobs, the newest of each token stay.
class JobTable {
 public:
  explicit JobTable(Database& database) : database_(database) {}

  // kBusy: the share of its token is used up, also when an ended job is queued again.
  Status add(const JobRow& row);  // kInvalidArgument: the id exists already
  // State, message, attempt_count, scan_id, started_at_ms and finished_at_ms. kNotFound.
  Status update(const JobRow& row);
  Result<JobRow> find(const std::string& id);            // kNotFound
  Result<std::vector<JobRow>> list();                    // newest first, at most kMaxListedJobs
  Result<std::vector<JobRow>> in_state(JobState state);  // in the order in which they run
  Result<std::map<JobState, int>> count();               // of stored jobs, by state
  Status add_line(const std::string& id, const JobLine& line);  // kNotFound: no such job
  Result<std::vector<JobLine>> lines_of(const std::string& id);
  Result<int> forget(std::int64_t ended_before_ms);  // with their lines. Returns their number

 private:
  Database& database_;
};

}  // namespace hermite::server
