#include "server/service/batch.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "server/service/job_request.h"
#include "server/store/scan_id.h"
#include "server/store/unix_time.h"

namespace hermite {

namespace {

constexpr std::chrono::minutes kSweepPeriod(1);  // of uploads, which expire after hours

// Of a job that has ended.
void remove_unfinished_scan(const DataDirectory& data, Store& store, Blobs& blobs, const std::string& id) {
  const Result<ScanRow> scan = store.find(id);
  if (!scan.ok() || scan->phase == ScanPhase::kFinished) return;
  Status removed = blobs.remove(id);
  if (removed.ok()) removed = data.remove_scan_folder(id);
  if (removed.ok()) removed = store.remove(id);
  if (!removed.ok()) spdlog::warn("{}", removed.error().message);
}

}  // namespace

Status recover_batch(const DataDirectory& data, Store& store, Blobs& blobs) {
  const JobScans scans{[&store](const std::string& id) {
                         const Result<ScanRow> scan = store.find(id);
                         return scan.ok() && scan->phase == ScanPhase::kFinished;
                       },
                       [&](const std::string& id) { remove_unfinished_scan(data, store, blobs, id); }};
  return recover_jobs(store, scans, unix_now_ms());
}

Batch::Batch(int worker_count, const UploadLimits& limits, const DataDirectory& data, Store& store, Scans& scans, const Scans::Post& post)
    : store_(store),
      scans_(scans),
      job_world_{scans, data, post, {}, limits.min_free_disk_bytes},
      executor_(worker_count, store, executor_hooks(post)),
      uploads_(limits, data, store, [this](const UploadRow& row) { return submit(row); }) {}

LocalExecutor::Hooks Batch::executor_hooks(const Scans::Post& post) {
  return {[this](const JobRow& row, JobEvents events) { return std::make_unique<ScanJob>(job_world_, row, std::move(events)); },
          [this](const JobRow& row) { job_ended(row); }, unix_now_ms, new_scan_id, post};
}

// An upload that is whole becomes a job, once: one that failed is tried again when somebody says so.
Status Batch::submit(const UploadRow& row) {
  if (store_.job(row.id).ok()) return Done{};
  Result<JobRow> job = job_of_upload(row);
  if (!job.ok()) return job.error();
  job->created_at_ms = unix_now_ms();
  return executor_.submit(*job);
}

void Batch::job_ended(const JobRow& row) {
  if (row.state != JobState::kFinished && !row.scan_id.empty()) scans_.remove_unwanted(row.scan_id);
  if (row.source != JobSource::kUpload) return;
  if (row.state == JobState::kFinished)
    uploads_.forget(row.source_id);
  else
    uploads_.keep(row.source_id, unix_now_ms());
}

void Batch::tick(std::chrono::steady_clock::time_point now) {
  executor_.tick();
  if (now < sweep_at_) return;
  sweep_at_ = now + kSweepPeriod;
  uploads_.sweep(unix_now_ms());
}

}  // namespace hermite
