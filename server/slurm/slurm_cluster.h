// The cluster as this server sees it: a thread that runs Slurm's programs and reads what nodes
// write, one after another, so that neither a slow controller nor a slow shared disk holds anything
// else up. All jobs together are asked for by one squeue a period.
//
// A job is known by its name, which is unique for each attempt and is in the attempt's folder
// before it is submitted. So a server that died between submitting a job and hearing its number
// finds it again, and submits nothing twice.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "core/base/result.h"
#include "server/slurm/attempts.h"
#include "server/slurm/slurm_text.h"
#include "server/slurm/task_queue.h"

namespace hermite::server {

struct SlurmOptions {
  std::string folder;     // that all nodes see under the same name
  std::string owner;      // names this server in its folder; empty: the folder is surely its own
  std::string program;    // hermite, on the nodes
  std::string partition;  // empty: the cluster's default
  std::vector<std::string> arguments;  // more arguments of sbatch
  int time_limit_min = 0;              // 0: that of the partition
  int memory_mb = 0;                   // for each job; 0: from what jobs have taken
  // As in NodeOrder.
  std::string device;
  int gpu_memory_mb = 0;
  int checkpoint_period_ms = 0;
  int min_free_disk_mb = 0;
  std::chrono::milliseconds poll_period{2000};
};

// What is asked for before any job has ended, and the least: the process without its scan.
inline constexpr int kFirstMemory_mb = 4000, kLeastMemory_mb = 1000;

// What the last polls have said of an attempt.
struct SeenJob {
  std::optional<SlurmJob> job;  // none: the controller does not know it
  JobStage stage;               // of a running one
  int same_count = 0;           // so many polls in a row have said this state
};

class SlurmCluster {
 public:
  // Creates the folder. Attempts of jobs that are not among `living_jobs` are dismissed, so the
  // folder must be of this server alone. Throws SetupError, also if another one has written its
  // name there. The functions are for the network thread unless stated otherwise.
  SlurmCluster(SlurmOptions options, const std::set<std::string>& living_jobs);
  ~SlurmCluster();  // stop()
  SlurmCluster(const SlurmCluster&) = delete;
  SlurmCluster& operator=(const SlurmCluster&) = delete;

  const SlurmOptions& options() const { return options_; }
  std::string job_folder(const std::string& job_id) const { return options_.folder + "/" + job_id; }

  // Runs a function on the cluster's thread soon, or never once stop() was called. Any thread.
  void later(std::function<void()> action) { queue_.push(std::move(action)); }

  // Ends the thread, after the program that it is waiting for.
  void stop();

  // On the cluster's thread. Submits the attempt unless that was done before, which is asked if
  // `may_be_submitted`, and watches it from now on. Returns Slurm's number of the job.
  // kUnavailable, kNotFound, kIo: Slurm refuses or does not answer, with its words.
  Result<std::string> submit(const Attempt& attempt, int memory_mb, bool may_be_submitted);

  // What was seen since it is watched; std::nullopt: nothing yet. Any thread.
  std::optional<SeenJob> seen(const std::string& name) const;
  void forget(const std::string& name);  // any thread

  // Closes all present attempts of a job, cancels them in Slurm and removes their folders, again
  // and again until Slurm has answered.
  void dismiss(const std::string& job_id);

  // What a job is to ask for, from what earlier ones have taken.
  int memory_request_mb() const;
  void memory_taken(std::uint64_t bytes);

 private:
  using Clock = std::chrono::steady_clock;
  struct Watched {
    Attempt attempt;
    SeenJob seen;
    bool was_seen = false;
  };
  void work();
  void poll();
  void take(const std::vector<SlurmJob>& jobs);
  Result<std::vector<SlurmJob>> ask(const std::vector<std::string>& names);
  Result<std::string> number_in_cluster(const Attempt& attempt);
  Result<std::string> submit_anew(const Attempt& attempt, int memory_mb);
  void dismiss_now(const std::string& job_folder);
  void cancel_dismissed();

  const SlurmOptions options_;
  TaskQueue queue_;
  std::atomic<bool> stopped_ = false;
  double taken_mb_ = 0;  // mean of what jobs have taken; 0: none has ended

  mutable std::mutex mutex_;
  std::map<std::string, Watched> watched_;  // guarded by mutex_; by name

  std::map<std::string, std::string> dismissed_;  // on the thread: folders of attempts, by name
  Clock::time_point poll_at_;
  std::string trouble_;  // what was said of the last poll that failed
  std::thread thread_;   // last member: the thread uses the others
};

// Whether an attempt of the job is in the cluster, or was when the last server ended. Any thread.
bool is_in_cluster(const std::string& folder, const std::string& job_id);

}  // namespace hermite::server
