#include "server/slurm/slurm_cluster.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "core/dataset/text_file.h"
#include "core/output/ply.h"
#include "server/slurm/process.h"

namespace hermite::server {

namespace {

namespace fs = std::filesystem;

constexpr double kMemoryMargin = 1.5, kShareOfLast = 0.25;  // the latter as in Places

// How long Slurm's programs may take: their own MessageTimeout is 10 s by default, and some try
// again.
constexpr ProcessLimits kSlurmLimits{std::chrono::seconds(20), std::size_t{8} << 20};

// Runs a program of Slurm, whose words are the error if it fails.
Result<std::string> ask_slurm(const std::vector<std::string>& command) {
  const Result<ProcessResult> result = run_process(command, kSlurmLimits);
  if (!result.ok()) return result.error();
  if (result->exit_status == 0) return result->output;
  const std::string said = said_words(result->errors);
  return Error{
      ErrorCode::kUnavailable,
      fmt::format("{} failed: {}", command.front(),
                  said.empty() ? fmt::format("exit status {}", result->exit_status) : said)};
}

// Two servers would dismiss each other's jobs.
void own_folder(const SlurmOptions& options) {
  if (options.owner.empty()) return;
  const std::string path = options.folder + "/owner";
  const Result<std::string> owner = dataset::read_text_file(path, kMaxNodeMessageBytes);
  if (owner.ok() && *owner == options.owner) return;
  if (owner.ok())
    throw SetupError({ErrorCode::kInvalidArgument,
                      fmt::format("setting slurm-folder: {} is that of the server {}, this is {}: "
                                  "give each server a folder of its own, or remove {} if it was "
                                  "moved here",
                                  options.folder, *owner, options.owner, path)});
  if (owner.error().code != ErrorCode::kNotFound) throw SetupError(owner.error());
  or_throw(output::write_file_atomically(path, options.owner));
}

}  // namespace

SlurmCluster::SlurmCluster(SlurmOptions options, const std::set<std::string>& living_jobs)
    : options_(std::move(options)) {
  std::error_code error;
  fs::create_directories(options_.folder, error);
  if (!error) fs::permissions(options_.folder, fs::perms::owner_all, error);
  if (error)
    throw SetupError({ErrorCode::kIo,
                      fmt::format("creating the folder {}: {}", options_.folder, error.message())});
  own_folder(options_);
  for (const std::string& job : jobs_in(options_.folder))
    if (!living_jobs.contains(job)) dismiss(job);
  thread_ = std::thread([this] { work(); });
}

SlurmCluster::~SlurmCluster() { stop(); }

void SlurmCluster::stop() {
  stopped_ = true;
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

void SlurmCluster::work() {
  constexpr std::chrono::milliseconds kBreath(100);
  while (!stopped_) {
    queue_.run_some(kBreath);
    if (stopped_ || Clock::now() < poll_at_) continue;
    poll();
    cancel_dismissed();
    poll_at_ = Clock::now() + options_.poll_period;
  }
}

Result<std::vector<SlurmJob>> SlurmCluster::ask(const std::vector<std::string>& names) {
  const Result<std::string> answer = ask_slurm(squeue_command(names));
  if (!answer.ok()) return answer.error();
  return parse_squeue(*answer);
}

void SlurmCluster::poll() {
  std::vector<std::string> names;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, watched] : watched_) names.push_back(name);
  }
  if (names.empty()) return;
  const Result<std::vector<SlurmJob>> jobs = ask(names);
  if (jobs.ok()) {
    trouble_.clear();
    return take(*jobs);
  }
  if (std::exchange(trouble_, jobs.error().message) != jobs.error().message)
    spdlog::warn("the cluster does not say how its jobs are: {}", jobs.error().message);
}

void SlurmCluster::take(const std::vector<SlurmJob>& jobs) {
  std::map<std::string, Watched> watched;
  {
    const std::lock_guard lock(mutex_);
    watched = watched_;
  }
  for (auto& [name, one] : watched) {
    const auto job = std::find_if(jobs.begin(), jobs.end(), [&name = name](const SlurmJob& each) {
      return each.name == name;
    });
    const std::string before = one.seen.job ? one.seen.job->state : "";
    one.seen.job = job == jobs.end() ? std::nullopt : std::optional(*job);
    const std::string state = one.seen.job ? one.seen.job->state : "";
    one.seen.same_count = one.was_seen && state == before ? one.seen.same_count + 1 : 1;
    one.was_seen = true;
    if (!one.seen.job) continue;
    one.seen.stage = {has_begun(*job) ? "starting" : "waiting in the cluster"};
    if (has_begun(*job))
      if (Result<JobStage> stage = read_progress(one.attempt.folder, job->restarts); stage.ok())
        one.seen.stage = *std::move(stage);
  }
  const std::lock_guard lock(mutex_);
  for (auto& [name, one] : watched)
    if (const auto still = watched_.find(name); still != watched_.end())
      still->second = std::move(one);
}

Result<std::string> SlurmCluster::number_in_cluster(const Attempt& attempt) {
  const Result<std::vector<SlurmJob>> jobs = ask({attempt.name});
  if (!jobs.ok()) return jobs.error();
  return jobs->empty() ? std::string() : jobs->front().number;
}

Result<std::string> SlurmCluster::submit_anew(const Attempt& attempt, int memory_mb) {
  SlurmRequest request;
  request.name = attempt.name;
  request.comment = fmt::format("hermite, attempt {}", attempt.number);
  request.folder = attempt.folder;
  request.partition = options_.partition;
  request.arguments = options_.arguments;
  request.time_limit_min = options_.time_limit_min;
  request.memory_mb = memory_mb;
  const Result<std::string> answer = ask_slurm(sbatch_command(request));
  return answer.ok() ? parse_job_number(*answer) : answer;
}

Result<std::string> SlurmCluster::submit(const Attempt& attempt, int memory_mb,
                                         bool may_be_submitted) {
  std::string number = number_of(attempt);
  if (number.empty() && may_be_submitted) {
    const Result<std::string> found = number_in_cluster(attempt);
    if (!found.ok()) return found;
    number = *found;
  }
  if (number.empty()) {
    const Result<std::string> submitted = submit_anew(attempt, memory_mb);
    if (!submitted.ok()) return submitted;
    number = *submitted;
  }
  // Without it, the job is found by its name.
  if (const Status kept = keep_number(attempt, number); !kept.ok())
    spdlog::warn("{}", kept.error().message);
  const std::lock_guard lock(mutex_);
  watched_[attempt.name] = {attempt, {}, false};
  return number;
}

std::optional<SeenJob> SlurmCluster::seen(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = watched_.find(name);
  if (found == watched_.end() || !found->second.was_seen) return std::nullopt;
  return found->second.seen;
}

void SlurmCluster::forget(const std::string& name) {
  const std::lock_guard lock(mutex_);
  watched_.erase(name);
}

void SlurmCluster::dismiss(const std::string& job_id) {
  later([this, folder = job_folder(job_id)] { dismiss_now(folder); });
}

void SlurmCluster::dismiss_now(const std::string& job_folder) {
  for (const Attempt& attempt : attempts_of(job_folder)) {
    if (const Status closed = close_attempt(attempt.folder); !closed.ok())
      spdlog::warn("{}", closed.error().message);
    forget(attempt.name);
    // One that has no name was never submitted.
    dismissed_[attempt.name.empty() ? attempt.folder : attempt.name] = attempt.folder;
  }
  std::error_code error;
  fs::remove(job_folder, error);  // if nothing was ever in it
  poll_at_ = {};
}

void SlurmCluster::cancel_dismissed() {
  if (dismissed_.empty()) return;
  std::vector<std::string> names;
  for (const auto& [name, folder] : dismissed_)
    if (name != folder) names.push_back(name);
  if (!names.empty())
    if (const Result<std::string> answer = ask_slurm(scancel_command(names)); !answer.ok()) {
      if (std::exchange(trouble_, answer.error().message) != answer.error().message)
        spdlog::warn("jobs of the cluster are not cancelled yet: {}", answer.error().message);
      return;
    }
  for (const auto& [name, folder] : std::exchange(dismissed_, {})) {
    std::error_code error;
    fs::remove_all(folder, error);
    if (error) spdlog::warn("removing {}: {}", folder, error.message());
    fs::remove(fs::path(folder).parent_path(), error);  // once it is empty
  }
}

int SlurmCluster::memory_request_mb() const {
  if (options_.memory_mb > 0) return options_.memory_mb;
  if (taken_mb_ == 0) return kFirstMemory_mb;
  return std::max(kLeastMemory_mb, static_cast<int>(kMemoryMargin * taken_mb_));
}

void SlurmCluster::memory_taken(std::uint64_t bytes) {
  const double mb = static_cast<double>(bytes) / 1e6;
  taken_mb_ = taken_mb_ == 0 ? mb : (1 - kShareOfLast) * taken_mb_ + kShareOfLast * mb;
}

bool is_in_cluster(const std::string& folder, const std::string& job_id) {
  return open_attempt(folder + "/" + job_id).has_value();
}

}  // namespace hermite::server
