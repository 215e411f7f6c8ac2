#include "server/jobs/batch.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "server/jobs/import_job.h"
#include "server/jobs/job_request.h"
#include "server/store/scan_id.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

constexpr std::chrono::minutes kSweepPeriod(1);  // how often expired uploads are removed

// Removes the unfinished scan of a job that has ended.
void remove_unfinished_scan(const Storage& storage, const std::string& id) {
  const Result<ScanRow> scan = storage.store.scans.find(id);
  if (!scan.ok() || scan->phase == ScanPhase::kFinished) return;
  Status removed = remove_files_of_scan(storage, id);
  if (removed.ok()) removed = storage.store.scans.remove(id);
  if (!removed.ok()) spdlog::warn("{}", removed.error().message);
}

}  // namespace

Status recover_batch(const Storage& storage, std::function<bool(const JobRow&)> goes_on_elsewhere) {
  const JobScans scans{[&storage](const std::string& id) {
                         const Result<ScanRow> scan = storage.store.scans.find(id);
                         return scan.ok() && scan->phase == ScanPhase::kFinished;
                       },
                       [&storage](const std::string& id) { remove_unfinished_scan(storage, id); },
                       std::move(goes_on_elsewhere)};
  return recover_jobs(storage.store, scans, unix_now_ms());
}

Batch::Batch(BatchOptions options, const Storage& storage, Scans& scans,
             const LogReaders::Post& post)
    : options_(std::move(options)),
      store_(storage.store),
      scans_(scans),
      job_world_{scans, storage.data, post, {}, options_.uploads.min_free_disk_bytes},
      executor_(options_.worker_count + (options_.others ? options_.others->job_count : 0),
                storage.store, executor_hooks(post)),
      uploads_(options_.uploads, storage, [this](const UploadRow& row) { return submit(row); }) {}

LocalExecutor::Hooks Batch::executor_hooks(const LogReaders::Post& post) {
  LocalExecutor::Hooks hooks{
      [this](const JobRow& row, JobEvents events) { return start(row, std::move(events)); },
      [this](const JobRow& row) { job_ended(row); }, unix_now_ms, new_scan_id, post};
  if (options_.others) hooks.has_room = [this](const JobRow& row) { return has_room(row); };
  return hooks;
}

std::unique_ptr<JobWork> Batch::start(const JobRow& row, JobEvents events) {
  if (is_import(job_world_.data, row))
    return std::make_unique<ImportJob>(job_world_, row, std::move(events));
  if (options_.others) return options_.others->start(job_world_, row, std::move(events));
  return std::make_unique<ScanJob>(job_world_, row, std::move(events));
}

// Waiting jobs are asked often, and asking opens a file.
bool Batch::is_import_job(const JobRow& row) {
  const auto [known, is_new] = is_import_.try_emplace(row.id, false);
  if (is_new) known->second = is_import(job_world_.data, row);
  return known->second;
}

// Imports do not wait for the cluster, nor are there more of them at once than without one.
bool Batch::has_room(const JobRow& row) {
  const bool import = is_import_job(row);
  const std::size_t count = executor_.count_running(
      [this, import](const JobRow& other) { return is_import_job(other) == import; });
  return count <
         static_cast<std::size_t>(import ? options_.worker_count : options_.others->job_count);
}

// A complete upload becomes a job once; a failed job is retried only on request.
Status Batch::submit(const UploadRow& row) {
  if (store_.jobs.find(row.id).ok()) return Done{};
  Result<JobRow> job = job_of_upload(row);
  if (!job.ok()) return job.error();
  job->created_at_ms = unix_now_ms();
  return executor_.submit(*job);
}

void Batch::job_ended(const JobRow& row) {
  is_import_.erase(row.id);
  if (options_.others) options_.others->ended(row.id);
  if (row.state != JobState::kFinished && !row.scan_id.empty()) scans_.remove_unwanted(row.scan_id);
  if (row.source != JobSource::kUpload) return;
  if (row.state == JobState::kFinished)
    uploads_.forget(row.source_id);
  else
    uploads_.keep(row.source_id, unix_now_ms());
}

void Batch::tick(std::chrono::steady_clock::time_point now, std::int64_t retention_now_ms) {
  executor_.tick(now);
  if (now < sweep_at_) return;
  sweep_at_ = now + kSweepPeriod;
  uploads_.sweep(retention_now_ms);
}

}  // namespace hermite::server
