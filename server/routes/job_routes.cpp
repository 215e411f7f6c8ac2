#include "server/routes/job_routes.h"

#include <fmt/core.h>

#include <utility>

#include "server/jobs/job_request.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

// A token that may view all scans may view all jobs.
bool may_see_job(const Grant& grant, const JobRow& job) {
  return job.token_id == grant.token_id || may(grant, Scope::kView);
}

Result<JobStatus> find_job(const HttpWorld& world, const Call& call) {
  const Error none{ErrorCode::kNotFound, "there is no such job"};
  if (!is_scan_id(call.id)) return none;
  Result<JobStatus> job = world.executor.status(world.uploads.job_of(call.id));
  if (!job.ok() && job.error().code != ErrorCode::kNotFound) return job;
  if (!job.ok() || !may_see_job(call.grant, job->row)) return none;
  return job;
}

Result<std::string> told(const HttpWorld& world, const std::string& id) {
  const Result<JobStatus> job = world.executor.status(id);
  if (!job.ok()) return job.error();
  const Result<std::vector<JobLine>> log = world.executor.log(id);
  if (!log.ok()) return log.error();
  return job_json(*job, *log);
}

// Returns a job that the caller may change.
Result<JobStatus> find_own_job(const HttpWorld& world, const Call& call) {
  Result<JobStatus> job = find_job(world, call);
  if (job.ok() && job->row.token_id != call.grant.token_id && !may(call.grant, Scope::kAdmin))
    return Error{ErrorCode::kUnauthorized, "this job is another token's; admin is needed"};
  return job;
}

HttpAnswer refused_job(const Error& error) {
  return error.code == ErrorCode::kUnauthorized ? error_answer(403, error) : refused(error);
}

}  // namespace

HttpAnswer list_jobs(const HttpWorld& world, const Call& call) {
  Result<std::vector<JobStatus>> jobs = world.executor.list();
  if (!jobs.ok()) return refused(jobs.error());
  std::erase_if(*jobs, [&call](const JobStatus& job) { return !may_see_job(call.grant, job.row); });
  return made(jobs_json(*jobs));
}

HttpAnswer show_job(const HttpWorld& world, const Call& call) {
  const Result<JobStatus> job = find_job(world, call);
  return job.ok() ? made(told(world, job->row.id)) : refused(job.error());
}

HttpAnswer create_job(const HttpWorld& world, const Call& call) {
  Result<JobRow> job = job_of_request(call.request.body);
  if (!job.ok()) return refused(job.error());
  if (Status status = check_priority(*job, may(call.grant, Scope::kAdmin)); !status.ok())
    return refused_job(status.error());
  const Result<ScanRow> scan = world.scans.rows().find(job->source_id);
  if (!scan.ok()) return refused(scan.error());
  if (scan->phase == ScanPhase::kRunning)
    return refused({ErrorCode::kBusy, fmt::format("scan {} is running", scan->id)});
  if (job->title.empty()) job->title = scan->title;
  job->id = new_scan_id();
  job->token_id = call.grant.token_id;
  job->created_at_ms = call.request.caller.now_ms;
  if (Status status = world.executor.submit(*job); !status.ok()) return refused(status.error());
  return made(told(world, job->id), 201);
}

HttpAnswer cancel_job(const HttpWorld& world, const Call& call) {
  const Result<JobStatus> job = find_own_job(world, call);
  if (!job.ok()) return refused_job(job.error());
  if (Status status = world.executor.cancel(job->row.id); !status.ok())
    return refused(status.error());
  return made(told(world, job->row.id));
}

HttpAnswer retry_job(const HttpWorld& world, const Call& call) {
  const Result<JobStatus> job = find_own_job(world, call);
  if (!job.ok()) return refused_job(job.error());
  const JobRow& row = job->row;
  if (row.state != JobState::kFailed && row.state != JobState::kCancelled)
    return refused({ErrorCode::kBusy, fmt::format("the job is {}: there is nothing to try again",
                                                  name_of(row.state))});
  if (row.source == JobSource::kUpload && !world.store.uploads.find(row.source_id).ok())
    return refused({ErrorCode::kNotFound, "the upload of this job has expired: upload it again"});
  JobRow again = row;
  again.state = JobState::kQueued;
  if (Status status = world.executor.submit(again); !status.ok()) return refused(status.error());
  return made(told(world, again.id));
}

}  // namespace hermite::server
