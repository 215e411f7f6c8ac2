// The queue of this server's jobs: a limited number at once, by priority, then by age. This process
// or others do their work (server/slurm). Jobs are rows of the store, so that queued ones survive
// the server; one that ran is retried, kMaxAttempts in all. Belongs to the network thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/disk/pending_changes.h"
#include "server/jobs/executor.h"
#include "server/store/store.h"
#include "server/store/unix_time.h"

namespace hermite::server {

inline constexpr int kMaxAttempts = 3;  // a job that crashes its server must not do so for ever
// A retry costs a whole scan.
inline constexpr std::int64_t kFirstRoomPause_ms = 5000, kLongestRoomPause_ms = 3'600'000;
inline constexpr std::int64_t kForgetJobsAfter_ms = 90 * kDay_ms;

struct JobEnd {
  // Queued: the server stops, and the next server continues the job.
  JobState state = JobState::kFinished;
  std::string message;
  bool lacked_room = false;  // queued: the disk had no room; it is retried with growing pauses
};

// Events of a job, on the network thread.
struct JobEvents {
  std::function<void(JobStage)> progress;
  std::function<void(const std::string&)> log;
  // Exactly once, as the last event, never from inside a call of JobWork.
  std::function<void(JobEnd)> ended;
};

// A running job. Destroyed on the network thread, at the latest after it has ended.
class JobWork {
 public:
  virtual ~JobWork() = default;
  virtual void cancel() = 0;  // ends soon and leaves nothing behind
  virtual void stop() = 0;    // ends soon, as queued or finished
  virtual void tick() = 0;    // called periodically
};

class LocalExecutor : public Executor {
 public:
  struct Hooks {
    std::function<std::unique_ptr<JobWork>(const JobRow&, JobEvents)> start;
    std::function<void(const JobRow&)> ended;  // will not be retried
    std::function<std::int64_t()> now_ms;
    std::function<std::string()> new_scan_id;
    std::function<void(std::function<void()>)> post;  // runs a function on this thread soon
    // Whether this job may start beside those that run; empty: every one may.
    std::function<bool(const JobRow&)> has_room = {};
  };

  // `store` outlives this.
  LocalExecutor(int worker_count, Store& store, Hooks hooks);
  ~LocalExecutor() override;

  Status submit(const JobRow& job) override;
  Result<JobStatus> status(const std::string& id) override;
  Status cancel(const std::string& id) override;
  Result<std::vector<JobStatus>> list() override;
  Result<std::vector<JobLine>> log(const std::string& id) override;

  void tick(std::chrono::steady_clock::time_point now);  // called periodically: starts queued jobs
  void refuse_new();                                     // starts no more jobs
  // Stops running jobs; the next server continues them.
  void stop();
  std::size_t running_count() const { return running_.size(); }
  std::size_t count_running(const std::function<bool(const JobRow&)>& which) const;

 private:
  struct Running {
    JobRow row;
    JobStage stage;
    std::unique_ptr<JobWork> work;
  };
  std::size_t next_of(const std::vector<JobRow>& waiting) const;
  Status put_away(JobRow row);
  void start(JobRow row);
  void ended(const std::string& id, const JobEnd& end);
  void note(const std::string& id, const std::string& message);
  void put_off(const std::string& id, const std::string& message);
  JobStatus with_stage(JobRow row) const;
  Result<JobRow> row_of(const std::string& id) const;

  const int worker_count_;
  Store& store_;
  const Hooks hooks_;
  std::map<std::string, Running> running_;  // by id
  struct Pause {
    std::int64_t length_ms = 0;
    std::int64_t until_ms = 0;
  };
  // Otherwise an ended job would be running until the next server.
  PendingChanges<JobRow> unstored_ends_;
  // By id, for jobs that the disk had no room for.
  std::map<std::string, Pause> pauses_;
  // By token: the sequence number of its last start.
  std::map<std::string, std::uint64_t> last_start_;
  std::uint64_t start_count_ = 0;
  bool stopping_ = false;
  std::chrono::steady_clock::time_point store_asked_again_at_;
};

// Recovers the jobs of a server that died, before their scans are touched: running jobs are queued
// again, or fail after kMaxAttempts attempts. `is_finished` and `remove_scan` are called with the
// id of a job's scan. kIo.
struct JobScans {
  std::function<bool(const std::string&)> is_finished;
  std::function<void(const std::string&)> remove_unfinished;
  // Whether other machines work on the job, so that the end of the server was not the end of an
  // attempt; empty: they never do.
  std::function<bool(const JobRow&)> goes_on_elsewhere = {};
};
Status recover_jobs(Store& store, const JobScans& scans, std::int64_t now_ms);

}  // namespace hermite::server
