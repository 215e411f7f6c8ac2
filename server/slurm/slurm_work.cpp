#include "server/slurm/slurm_work.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "server/jobs/job_request.h"
#include "server/slurm/take_result.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

// Slurm may show a state briefly that is not the last one, as before it puts a job back into its
// queue; and a node's file may be seen a moment later here.
constexpr int kPollsToBelieve = 2;
// A shared file system may show a new file much later: NFS remembers for up to a minute what a
// folder has. So often, and in these intervals, the outcome of a run is looked for.
constexpr int kMostMissing = 40;
constexpr std::chrono::seconds kMissingPause(2);
constexpr int kMostTold = 50;  // lines about one attempt

}  // namespace

SlurmWork::SlurmWork(SlurmCluster& cluster, const ScanJobWorld& world, JobRow row, JobEvents events)
    : cluster_(cluster), world_(world), row_(std::move(row)), events_(std::move(events)) {
  memory_mb_ = cluster_.memory_request_mb();
  const std::string upload_id = row_.source == JobSource::kUpload ? row_.source_id : "";
  const Status storage =
      world_.scans.room().check_storage(world_.scans.rows().owner_of(row_.token_id), upload_id);
  if (storage.ok())
    begin_attempt();
  else
    end({JobState::kFailed, storage.error().message});
}

SlurmWork::~SlurmWork() {
  if (attempt_) cluster_.forget(attempt_->name);
}

// One step at a time: a job that is cancelled or stopped meanwhile ends after it.
template <class Answer>
void SlurmWork::on_cluster(std::function<Answer()> ask, std::function<void(Answer)> then) {
  is_busy_ = true;
  cluster_.later([this, post = world_.post, alive = std::weak_ptr<bool>(alive_),
                  ask = std::move(ask), then = std::move(then)] {
    auto answer = std::make_shared<Answer>(ask());
    post([this, alive, answer, then] {
      if (!alive.lock()) return;
      is_busy_ = false;
      if (cancelled_) return end({JobState::kCancelled, {}});
      then(std::move(*answer));
    });
  });
}

NodeOrder SlurmWork::order() const {
  NodeOrder order;
  order.job = row_;
  if (row_.source == JobSource::kScan)
    if (const Result<ScanRow> scan = world_.scans.rows().find(row_.source_id); scan.ok())
      order.logged_frame_count = static_cast<std::uint64_t>(scan->frames_received);
  order.device = cluster_.options().device;
  order.gpu_memory_mb = cluster_.options().gpu_memory_mb;
  order.checkpoint_period_ms = cluster_.options().checkpoint_period_ms;
  order.min_free_disk_mb = cluster_.options().min_free_disk_mb;
  return order;
}

void SlurmWork::begin_attempt() {
  attempt_.reset();
  is_submitted_ = may_be_submitted_ = false;
  const OrderSource source{row_.source == JobSource::kScan
                               ? world_.data.log_folder(row_.source_id)
                               : world_.data.upload_path(row_.source_id),
                           cluster_.options().program};
  on_cluster<Result<Begun>>(
      [folder = cluster_.job_folder(row_.id), order = order(), source]() -> Result<Begun> {
        if (const std::optional<Attempt> old = open_attempt(folder)) return Begun{*old, true};
        const Result<Attempt> made = create_attempt(folder, order, source);
        if (!made.ok()) return made.error();
        return Begun{*made, false};
      },
      [this](const Result<Begun>& answer) { begun(answer); });
}

void SlurmWork::begun(const Result<Begun>& begun) {
  if (stopping_) return end({JobState::kQueued, {}});
  if (!begun.ok()) {
    // Without its frames, nobody will be able to process a scan again.
    if (begun.error().code == ErrorCode::kNotFound)
      return end({JobState::kFailed, "the frames of the scan are not kept any more"});
    return end({JobState::kQueued, begun.error().message, true});
  }
  attempt_ = begun->attempt;
  restarts_ = told_count_ = missing_count_ = 0;
  may_be_submitted_ = begun->is_old;
  submit();
}

void SlurmWork::submit() {
  submit_at_.reset();
  events_.progress({"submitting"});
  on_cluster<Result<std::string>>(
      [cluster = &cluster_, attempt = *attempt_, memory_mb = memory_mb_,
       maybe = may_be_submitted_] { return cluster->submit(attempt, memory_mb, maybe); },
      [this](const Result<std::string>& number) { submitted(number); });
}

void SlurmWork::submitted(const Result<std::string>& number) {
  may_be_submitted_ = true;
  if (number.ok()) {
    is_submitted_ = true;
    told_.clear();
    events_.progress({"waiting in the cluster"});
    events_.log(fmt::format("job {} of the cluster, attempt {}", *number, attempt_->number));
    return stopping_ ? end({JobState::kQueued, {}}) : void();
  }
  if (stopping_) return end({JobState::kQueued, {}});
  const std::string& why = number.error().message;
  if (std::exchange(told_, why) != why)
    events_.log("the cluster does not take the job, and is asked again from time to time: " + why);
  events_.progress({"waiting for the cluster"});
  submit_at_ = Clock::now() + pause_;
  pause_ = std::min(2 * pause_, kLongestSubmitPause);
}

void SlurmWork::tick() {
  if (is_busy_ || ended_) return;
  if (submit_at_ && Clock::now() >= *submit_at_) return submit();
  if (!is_submitted_ || Clock::now() < look_at_) return;
  if (const std::optional<SeenJob> seen = cluster_.seen(attempt_->name)) look(*seen);
}

// In the job's log: why it waits, when that changes, and that it begins again.
void SlurmWork::tell(const SlurmJob& job) {
  if (told_count_ >= kMostTold) return;
  if (const std::string why = wait_words(job); !why.empty() && std::exchange(told_, why) != why) {
    ++told_count_;
    events_.log(why);
  }
  if (std::exchange(restarts_, job.restarts) != job.restarts && job.restarts > 0) {
    ++told_count_;
    events_.log(
        fmt::format("the cluster has put the job back into its queue, since its node failed or was "
                    "needed; this is run {}",
                    job.restarts + 1));
  }
}

void SlurmWork::look(const SeenJob& seen) {
  if (seen.job && !is_over(*seen.job)) {
    tell(*seen.job);
    return events_.progress(seen.stage);
  }
  const bool is_plain = seen.job && seen.job->state == "COMPLETED";
  if (!is_plain && seen.same_count < kPollsToBelieve) return;
  read_end(seen.job);
}

// Of the last run, as Slurm counts; one that it has forgotten can only be the newest.
void SlurmWork::read_end(const std::optional<SlurmJob>& job) {
  events_.progress({"finishing"});
  on_cluster<Left>(
      [folder = attempt_->folder, job] {
        const int run = job ? job->restarts : newest_run(folder);
        return Left{run, read_outcome(folder, run), last_words(folder)};
      },
      [this, job](const Left& left) { ended_there(job, left); });
}

void SlurmWork::ended_there(const std::optional<SlurmJob>& job, const Left& left) {
  const Result<NodeOutcome>& outcome = left.outcome;
  if (outcome.ok() && outcome->peak_memory_bytes > 0)
    cluster_.memory_taken(outcome->peak_memory_bytes);
  const bool is_missing = !outcome.ok() && outcome.error().code == ErrorCode::kNotFound;
  if (is_missing && job && job->state == "COMPLETED" && ++missing_count_ < kMostMissing) {
    look_at_ = Clock::now() + kMissingPause;
    return;
  }
  cluster_.forget(attempt_->name);
  is_submitted_ = false;
  if (outcome.ok() && outcome->end == NodeEnd::kFinished) return take_in(*outcome, left.run);
  if (outcome.ok())
    for (const std::string& line : outcome->lines) events_.log(line);
  else if (!left.last_words.empty())
    events_.log("the last that it printed: " + clean_title(left.last_words));
  if (outcome.ok() && outcome->end == NodeEnd::kFailed)
    return end({JobState::kFailed, outcome->words});
  if (job && was_cancelled(*job)) return end({JobState::kFailed, end_words(*job)});
  if (job && lacked_memory(*job)) memory_mb_ *= 2;
  const bool left_early = outcome.ok() && outcome->end == NodeEnd::kStopped;
  if (outcome.ok() && outcome->end == NodeEnd::kNoRoom)
    return close_and([this, words = outcome->words] { end({JobState::kQueued, words, true}); });
  try_again(!job         ? "the cluster does not know the job any more, and there is no result"
            : left_early ? "job " + job->number + " of the cluster" +
                               (job->nodes.empty() ? "" : " on " + job->nodes) +
                               " was told to leave before it was done, as before its time limit"
                         : end_words(*job));
}

void SlurmWork::take_in(const NodeOutcome& outcome, int run) {
  if (const Status room = world_.scans.room().check_disk(); !room.ok())
    return end({JobState::kQueued, room.error().message, true});
  world_.scans.remove_unwanted(row_.scan_id);  // what a server left that died while it took it
  on_cluster<Status>(
      [folder = run_folder(attempt_->folder, run) + "/" + kResultName, scan = row_.scan_id,
       data = &world_.data,
       blobs = &world_.scans.blobs()] { return take_result(folder, scan, *data, *blobs); },
      [this, outcome](const Status& status) { taken(outcome, status); });
}

void SlurmWork::taken(const NodeOutcome& outcome, const Status& status) {
  ScanRow scan = outcome.scan;
  scan.id = row_.scan_id;
  scan.token_id = row_.token_id;
  scan.finished_at_ms = unix_now_ms();
  const Status added = status.ok() ? world_.scans.add_imported(scan, true) : status;
  if (!added.ok()) {
    // The result is still where it was.
    world_.scans.remove_unwanted(row_.scan_id);
    return end({JobState::kQueued, added.error().message, true});
  }
  for (const std::string& line : outcome.lines) events_.log(line);
  end({JobState::kFinished, outcome.words});
}

void SlurmWork::try_again(const std::string& why) {
  if (stopping_) return end({JobState::kQueued, {}});
  if (attempt_->number >= kMaxAttempts)
    return end({JobState::kFailed, fmt::format("{}; it was tried {} times, and is not tried again",
                                               why, attempt_->number)});
  events_.log(why + "; it is tried again");
  close_and([this] { begin_attempt(); });
}

void SlurmWork::close_and(std::function<void()> then) {
  on_cluster<Status>([folder = attempt_->folder] { return close_attempt(folder); },
                     [this, then = std::move(then)](const Status& closed) {
                       if (!closed.ok())
                         return end({JobState::kQueued, closed.error().message, true});
                       then();
                     });
}

void SlurmWork::cancel() {
  cancelled_ = true;
  if (!is_busy_) end({JobState::kCancelled, {}});
}

// The attempt goes on without this server.
void SlurmWork::stop() {
  stopping_ = true;
  if (!is_busy_) end({JobState::kQueued, {}});
}

void SlurmWork::end(JobEnd how) {
  if (std::exchange(ended_, true)) return;
  world_.post([this, alive = std::weak_ptr<bool>(alive_), how = std::move(how)] {
    if (alive.lock()) events_.ended(how);
  });
}

}  // namespace hermite::server
