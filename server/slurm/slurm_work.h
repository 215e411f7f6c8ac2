// A batch job that a node of a Slurm cluster does (attempts.h has the folders, the fencing and how
// an interrupted run goes on).
//
// The server makes an attempt, submits it, and takes the result in when Slurm says that it has
// ended. Slurm itself puts a job back into its queue when its node fails or when it is preempted;
// if an attempt ends otherwise without a result, the server makes the next one, kMaxAttempts in
// all. A job that somebody has cancelled in Slurm fails. While Slurm does not take the job, it is
// offered again with growing pauses, for as long as it takes. When the server stops, the attempt
// goes on; the next server finds it.
//
// Nobody sees such a scan grow: it appears when it is finished.
//
// Belongs to the network thread. What blocks is done on the cluster's thread.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/jobs/local_executor.h"
#include "server/jobs/scan_job.h"
#include "server/slurm/slurm_cluster.h"

namespace hermite::server {

// Between two offers of a job that Slurm does not take.
inline constexpr std::chrono::seconds kFirstSubmitPause(5), kLongestSubmitPause(300);

class SlurmWork : public JobWork {
 public:
  // Starts working. `row` has the id of the new scan. `cluster` and `world` outlive this.
  SlurmWork(SlurmCluster& cluster, const ScanJobWorld& world, JobRow row, JobEvents events);
  ~SlurmWork() override;
  SlurmWork(const SlurmWork&) = delete;
  SlurmWork& operator=(const SlurmWork&) = delete;

  // Whoever hears that the job has ended dismisses its attempts.
  void cancel() override;
  void stop() override;
  void tick() override;

 private:
  using Clock = std::chrono::steady_clock;
  // What was found or made on the cluster's thread.
  struct Begun {
    Attempt attempt;
    bool is_old = false;  // an earlier server has made it
  };
  template <class Answer>
  void on_cluster(std::function<Answer()> ask, std::function<void(Answer)> then);

  void begin_attempt();
  void begun(const Result<Begun>& begun);
  void submit();
  void submitted(const Result<std::string>& number);
  void look(const SeenJob& seen);
  void tell(const SlurmJob& job);
  void read_end(const std::optional<SlurmJob>& job);
  // What a run has left, read on the cluster's thread.
  struct Left {
    int run = 0;
    Result<NodeOutcome> outcome;
    std::string last_words;  // that it printed
  };
  void ended_there(const std::optional<SlurmJob>& job, const Left& left);
  void take_in(const NodeOutcome& outcome, int run);
  void taken(const NodeOutcome& outcome, const Status& status);
  void try_again(const std::string& why);
  void close_and(std::function<void()> then);
  void end(JobEnd how);
  NodeOrder order() const;

  SlurmCluster& cluster_;
  const ScanJobWorld& world_;
  const JobRow row_;
  const JobEvents events_;
  // Functions posted for a destroyed job do nothing.
  const std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);

  std::optional<Attempt> attempt_;
  bool may_be_submitted_ = false;  // an earlier offer may have reached Slurm
  bool is_submitted_ = false;
  bool is_busy_ = false;  // the cluster's thread works for this
  bool cancelled_ = false, stopping_ = false, ended_ = false;
  int memory_mb_ = 0;
  std::chrono::seconds pause_ = kFirstSubmitPause;
  std::optional<Clock::time_point> submit_at_;
  int missing_count_ = 0;  // how often a finished run had no outcome yet
  Clock::time_point look_at_;
  std::string told_;  // the last trouble in the job's log
  int restarts_ = 0, told_count_ = 0;
};

}  // namespace hermite::server
