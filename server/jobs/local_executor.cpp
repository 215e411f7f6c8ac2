#include "server/jobs/local_executor.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/base/check.h"

namespace hermite::server {

LocalExecutor::LocalExecutor(int worker_count, Store& store, Hooks hooks)
    : worker_count_(worker_count),
      store_(store),
      hooks_(std::move(hooks)),
      unstored_ends_("job", "that it has ended",
                     [&store](const JobRow& row) { return store.jobs.update(row); }) {
  const Result<int> forgotten = store_.jobs.forget(hooks_.now_ms() - kForgetJobsAfter_ms);
  if (!forgotten.ok()) throw SetupError(forgotten.error());
}

LocalExecutor::~LocalExecutor() = default;

void LocalExecutor::note(const std::string& id, const std::string& message) {
  spdlog::info("job {}: {}", id, message);
  if (const Status kept = store_.jobs.add_line(id, {hooks_.now_ms(), message}); !kept.ok())
    spdlog::warn("the log of job {}: {}", id, kept.error().message);
}

Status LocalExecutor::submit(const JobRow& job) {
  CHECK(job.state == JobState::kQueued, "what is submitted waits");
  Result<JobRow> known = row_of(job.id);
  if (!known.ok() && known.error().code != ErrorCode::kNotFound) return known.error();
  if (known.ok()) {
    const bool again = known->state == JobState::kFailed || known->state == JobState::kCancelled;
    if (!again) return Done{};
    // A cancelled job may not have stopped yet.
    if (running_.contains(job.id))
      return Error{ErrorCode::kBusy,
                   fmt::format("job {} is just being ended; try again in a moment", job.id)};
    known->state = JobState::kQueued;
    known->message.clear();
    known->scan_id.clear();
    known->attempt_count = 0;
    known->started_at_ms = known->finished_at_ms = 0;
    if (Status status = store_.jobs.update(*known); !status.ok()) return status;
    unstored_ends_.forget(job.id);
    note(job.id, "submitted again");
    return Done{};
  }
  if (Status status = store_.jobs.add(job); !status.ok()) return status;
  note(job.id, "submitted");
  return Done{};
}

JobStatus LocalExecutor::with_stage(JobRow row) const {
  const auto running = running_.find(row.id);
  if (running == running_.end() || row.state != JobState::kRunning) return {std::move(row), {}};
  return {std::move(row), running->second.stage};
}

Result<JobRow> LocalExecutor::row_of(const std::string& id) const {
  const JobRow* const unstored = unstored_ends_.find(id);
  return unstored ? *unstored : store_.jobs.find(id);
}

Result<JobStatus> LocalExecutor::status(const std::string& id) {
  Result<JobRow> row = row_of(id);
  if (!row.ok()) return row.error();
  return with_stage(*std::move(row));
}

Result<std::vector<JobStatus>> LocalExecutor::list() {
  Result<std::vector<JobRow>> rows = store_.jobs.list();
  if (!rows.ok()) return rows.error();
  std::vector<JobStatus> jobs;
  for (JobRow& row : *rows) {
    const JobRow* const unstored = unstored_ends_.find(row.id);
    jobs.push_back(with_stage(unstored ? *unstored : std::move(row)));
  }
  return jobs;
}

Result<std::vector<JobLine>> LocalExecutor::log(const std::string& id) {
  if (const Result<JobRow> row = store_.jobs.find(id); !row.ok()) return row.error();
  return store_.jobs.lines_of(id);
}

Status LocalExecutor::cancel(const std::string& id) {
  Result<JobRow> row = row_of(id);
  if (!row.ok()) return row.error();
  if (row->state == JobState::kFailed) return put_away(*std::move(row));
  if (has_ended(row->state))
    return Error{ErrorCode::kBusy,
                 fmt::format("job {} has ended: it is {}", id, name_of(row->state))};
  // Stored at once, so that it stays cancelled even if the server dies now.
  row->state = JobState::kCancelled;
  row->message = "cancelled";
  row->finished_at_ms = hooks_.now_ms();
  if (Status status = store_.jobs.update(*row); !status.ok()) return status;
  unstored_ends_.forget(id);
  note(id, "cancelled");
  const auto running = running_.find(id);
  if (running == running_.end()) {
    pauses_.erase(id);
    hooks_.ended(*row);
    return Done{};
  }
  running->second.row = *row;
  running->second.work->cancel();
  return Done{};
}

// The log with its error is kept, and the job may be retried.
Status LocalExecutor::put_away(JobRow row) {
  row.state = JobState::kCancelled;
  if (Status status = store_.jobs.update(row); !status.ok()) return status;
  unstored_ends_.forget(row.id);
  note(row.id, "put away");
  return Done{};
}

void LocalExecutor::start(JobRow row) {
  row.state = JobState::kRunning;
  row.message.clear();
  ++row.attempt_count;
  row.started_at_ms = hooks_.now_ms();
  if (row.scan_id.empty()) row.scan_id = hooks_.new_scan_id();
  // Stored before the work creates anything that a crash could leave behind.
  if (Status status = store_.jobs.update(row); !status.ok()) {
    spdlog::error("job {} cannot start: {}", row.id, status.error().message);
    return;
  }
  note(row.id,
       "started" + (row.attempt_count == 1 ? "" : fmt::format(", attempt {}", row.attempt_count)));
  JobEvents events;
  events.progress = [this, id = row.id](JobStage stage) {
    if (const auto running = running_.find(id); running != running_.end())
      running->second.stage = std::move(stage);
  };
  events.log = [this, id = row.id](const std::string& message) { note(id, message); };
  events.ended = [this, id = row.id](const JobEnd& end) { ended(id, end); };
  const std::string id = row.id;
  running_[id] = {row, {"starting"}, nullptr};
  running_[id].work = hooks_.start(row, std::move(events));
}

void LocalExecutor::ended(const std::string& id, const JobEnd& end) {
  const auto running = running_.find(id);
  CHECK(running != running_.end(), "a job ends once");
  JobRow row = running->second.row;
  // Destroyed later, since the work itself calls this.
  hooks_.post([work = std::shared_ptr<JobWork>(std::move(running->second.work))] {});
  running_.erase(running);
  if (row.state != JobState::kCancelled) {
    row.state = end.state;
    row.message = end.message;
    // An interruption is no failed attempt.
    if (end.state == JobState::kQueued) --row.attempt_count;
    row.finished_at_ms = has_ended(end.state) ? hooks_.now_ms() : 0;
    (void)unstored_ends_.make(row);
    if (end.lacked_room) return put_off(id, row.message);
    note(id, std::string(end.state == JobState::kQueued ? "waits for the next server"
                                                        : name_of(row.state)) +
                 (row.message.empty() ? "" : ": " + row.message));
  }
  pauses_.erase(id);
  if (has_ended(row.state)) hooks_.ended(row);
}

void LocalExecutor::put_off(const std::string& id, const std::string& message) {
  Pause& pause = pauses_[id];
  pause.length_ms = pause.length_ms == 0 ? kFirstRoomPause_ms
                                         : std::min(2 * pause.length_ms, kLongestRoomPause_ms);
  pause.until_ms = hooks_.now_ms() + pause.length_ms;
  note(id, fmt::format("waits for room, and is tried again in {} s: {}", pause.length_ms / 1000,
                       message));
}

void LocalExecutor::tick(std::chrono::steady_clock::time_point now) {
  for (const auto& [id, running] : running_) running.work->tick();
  unstored_ends_.tick(now);
  if (stopping_ || unstored_ends_.full() ||
      running_.size() >= static_cast<std::size_t>(worker_count_) || now < store_asked_again_at_)
    return;
  Result<std::vector<JobRow>> waiting = store_.jobs.in_state(JobState::kQueued);
  if (!waiting.ok()) {
    spdlog::error("jobs: {}", waiting.error().message);
    // A database may be away for hours, and each time is a line of the log.
    store_asked_again_at_ = now + kChangeAgainAfter;
    return;
  }
  std::erase_if(*waiting, [this, now_ms = hooks_.now_ms()](const JobRow& row) {
    const auto pause = pauses_.find(row.id);
    return pause != pauses_.end() && now_ms < pause->second.until_ms;
  });
  while (!waiting->empty() && running_.size() < static_cast<std::size_t>(worker_count_)) {
    const auto next = waiting->begin() + static_cast<std::ptrdiff_t>(next_of(*waiting));
    if (hooks_.has_room && !hooks_.has_room(*next)) {
      waiting->erase(next);
      continue;
    }
    last_start_[next->token_id] = ++start_count_;
    start(std::move(*next));
    waiting->erase(next);
  }
}

// Selects by priority; then the token whose last turn is longest ago, so that a token with many
// jobs does not delay others; then the oldest job. `waiting` is in the order of the store.
std::size_t LocalExecutor::next_of(const std::vector<JobRow>& waiting) const {
  const auto last_start = [this](const JobRow& row) {
    const auto found = last_start_.find(row.token_id);
    return found == last_start_.end() ? 0 : found->second;
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < waiting.size() && waiting[i].priority == waiting.front().priority;
       ++i)
    if (last_start(waiting[i]) < last_start(waiting[best])) best = i;
  return best;
}

std::size_t LocalExecutor::count_running(const std::function<bool(const JobRow&)>& which) const {
  return static_cast<std::size_t>(
      std::count_if(running_.begin(), running_.end(),
                    [&which](const auto& entry) { return which(entry.second.row); }));
}

void LocalExecutor::refuse_new() { stopping_ = true; }

void LocalExecutor::stop() {
  stopping_ = true;
  for (const auto& [id, running] : running_) running.work->stop();
}

Status recover_jobs(Store& store, const JobScans& scans, std::int64_t now_ms) {
  const Result<std::vector<JobRow>> left = store.jobs.in_state(JobState::kRunning);
  if (!left.ok()) return left.error();
  for (JobRow row : *left) {
    const bool goes_on = scans.goes_on_elsewhere && scans.goes_on_elsewhere(row);
    if (scans.is_finished(row.scan_id)) {
      row.state = JobState::kFinished;
    } else if (goes_on) {
      row.state = JobState::kQueued;
      --row.attempt_count;
    } else if (row.attempt_count >= kMaxAttempts) {
      row.state = JobState::kFailed;
      row.message =
          fmt::format("the server ended {} times while it worked on this; it is not tried again",
                      row.attempt_count);
    } else {
      row.state = JobState::kQueued;
    }
    if (has_ended(row.state)) row.finished_at_ms = now_ms;
    if (Status status = store.jobs.update(row); !status.ok()) return status;
    const std::string message = row.state != JobState::kQueued ? name_of(row.state)
                                : goes_on ? "the server ended; the job went on without it"
                                          : "the server ended; the job waits again";
    if (Status status = store.jobs.add_line(row.id, {now_ms, message}); !status.ok()) return status;
  }
  for (const JobState state : {JobState::kFailed, JobState::kCancelled}) {
    const Result<std::vector<JobRow>> rows = store.jobs.in_state(state);
    if (!rows.ok()) return rows.error();
    for (const JobRow& row : *rows)
      if (!row.scan_id.empty()) scans.remove_unfinished(row.scan_id);
  }
  return Done{};
}

}  // namespace hermite::server
