#include "server/disk/orphans.h"

#include <spdlog/spdlog.h>

#include <set>
#include <string>
#include <vector>

namespace hermite::server {

namespace {

// Returns the ids of scans of jobs that have not ended, or the error of the store.
Result<std::set<std::string>> scans_of_jobs(Store& store) {
  std::set<std::string> ids;
  for (const JobState state : {JobState::kQueued, JobState::kRunning}) {
    const Result<std::vector<JobRow>> jobs = store.jobs.in_state(state);
    if (!jobs.ok()) return jobs.error();
    for (const JobRow& job : *jobs) ids.insert(job.scan_id);
  }
  return ids;
}

void tell_lost(const char* kind, const std::string& id, const Status& lost) {
  if (lost.ok())
    spdlog::warn(
        "no row of the database knows {0}s/{1}: moved to lost/{0}s/{1}, where it stays for {2} "
        "days",
        kind, id, kKeepLost.count());
  else
    spdlog::warn("no row of the database knows {}s/{}, and it stays there: {}", kind, id,
                 lost.error().message);
}

void clear_scans(const DataDirectory& data, Store& store, std::int64_t now_ms) {
  const Result<std::vector<std::string>> ids = data.scan_ids();
  const Result<std::set<std::string>> of_jobs = scans_of_jobs(store);
  if (!ids.ok() || !of_jobs.ok())
    return spdlog::warn("{}", (ids.ok() ? of_jobs.error() : ids.error()).message);
  for (const std::string& id : *ids) {
    const Result<ScanRow> row = store.scans.find(id);
    if (!row.ok() && row.error().code != ErrorCode::kNotFound)
      return spdlog::warn("{}", row.error().message);
    if (!row.ok() && !of_jobs->contains(id)) {
      tell_lost("scan", id, data.set_aside().lose_scan(id, now_ms));
    } else if (const int count = data.remove_unfinished_files(id); count > 0) {
      spdlog::info("scan {}: {} unfinished file(s) of an earlier server removed", id, count);
    }
  }
}

void clear_uploads(const DataDirectory& data, Store& store, std::int64_t now_ms) {
  const Result<std::vector<std::string>> ids = data.upload_ids();
  if (!ids.ok()) return spdlog::warn("{}", ids.error().message);
  for (const std::string& id : *ids) {
    const Result<UploadRow> row = store.uploads.find(id);
    if (!row.ok() && row.error().code != ErrorCode::kNotFound)
      return spdlog::warn("{}", row.error().message);
    if (!row.ok()) tell_lost("upload", id, data.set_aside().lose_upload(id, now_ms));
  }
}

}  // namespace

void clear_orphans(const DataDirectory& data, Store& store, std::int64_t now_ms) {
  constexpr std::int64_t kKeepLost_ms = std::chrono::milliseconds(kKeepLost).count();
  for (const std::string& place : data.set_aside().discard_lost(now_ms - kKeepLost_ms))
    spdlog::warn("{} was lost for {} days and is removed", place, kKeepLost.count());
  clear_scans(data, store, now_ms);
  clear_uploads(data, store, now_ms);
}

}  // namespace hermite::server
