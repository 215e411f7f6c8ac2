#include "server/jobs/import_job.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <filesystem>
#include <system_error>
#include <utility>

#include "core/dataset/text_file.h"
#include "server/jobs/job_request.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

// Results in bytes of the upload: a point may take 12 bytes there, and takes 51 in cloud.ply plus
// its part of the viewer's chunks.
constexpr std::uint64_t kResultsOfUpload = 5;

std::string one_text(const std::vector<std::string>& sentences) {
  std::string all;
  for (const std::string& sentence : sentences) all += (all.empty() ? "" : " ") + sentence;
  return all;
}

}  // namespace

bool is_import(const DataDirectory& data, const JobRow& row) {
  if (row.source != JobSource::kUpload) return false;
  const Result<bool> is_model = imports::is_model_file(data.upload_path(row.source_id));
  return is_model.ok() && *is_model;
}

ImportJob::ImportJob(const ScanJobWorld& world, JobRow row, JobEvents events)
    : world_(world), row_(std::move(row)), events_(std::move(events)) {
  world_.scans.remove_unwanted(row_.scan_id);  // remains of an attempt that ended with its server
  std::error_code error;
  const std::uintmax_t bytes =
      std::filesystem::file_size(world_.data.upload_path(row_.source_id), error);
  room_bytes_ = error ? 0 : kResultsOfUpload * bytes;
  const Status room =
      error ? Status(Error{ErrorCode::kIo, "the upload cannot be read: " + error.message()})
            : world_.scans.room().check_import(
                  row_.source_id, world_.scans.rows().owner_of(row_.token_id), room_bytes_);
  thread_ = std::thread([this, room] { run(room); });
}

ImportJob::~ImportJob() {
  stopped_ = true;
  thread_.join();
}

void ImportJob::on_network(std::function<void()> action) {
  world_.post([alive = std::weak_ptr<bool>(alive_), action = std::move(action)] {
    if (alive.lock()) action();
  });
}

void ImportJob::report(const char* stage) {
  on_network([this, stage] { events_.progress({stage}); });
}

void ImportJob::run(const Status& room) {
  Result<Summary> summary = Error{};
  try {
    summary = room.ok() ? import() : Result<Summary>(room.error());
  } catch (const std::exception& error) {
    // Most likely out of memory: only this job fails.
    summary = Error{ErrorCode::kIo, std::string("the job failed: ") + error.what()};
  }
  on_network([this, summary = std::move(summary)] { thread_ended(summary); });
}

// On success the scan has all of its files.
Result<ImportJob::Summary> ImportJob::import() {
  report("reading");
  const Result<imports::ImportOptions> options = imports::parse_import_options(settings_of(row_));
  if (!options.ok()) return options.error();
  Result<std::string> bytes =
      dataset::read_text_file(world_.data.upload_path(row_.source_id), imports::kMaxModel_bytes);
  if (!bytes.ok() && bytes.error().code == ErrorCode::kTooLarge)
    return Error{ErrorCode::kTooLarge,
                 fmt::format("the file has more than the {} bytes that a cloud or mesh may have",
                             imports::kMaxModel_bytes)};
  if (!bytes.ok()) return Error{bytes.error().code, "the upload cannot be read"};
  const Result<ImportResults> results =
      results_of_import(*std::move(bytes), *options, [this] { return !stopped_; });
  if (!results.ok()) return results.error();
  report("storing");
  for (const output::NamedFile& file : results->files) {
    if (stopped_) return Error{ErrorCode::kBusy, "stopped"};
    if (Status put = world_.scans.blobs().put(row_.scan_id, file.name, file.bytes); !put.ok())
      return put.error();
  }
  return Summary{results->remarks, results->may_be_meshed};
}

void ImportJob::cancel() {
  cancelled_ = true;
  stopped_ = true;
}

void ImportJob::stop() { stopped_ = true; }

void ImportJob::thread_ended(const Result<Summary>& summary) {
  const bool was_stopped = !summary.ok() && summary.error().code == ErrorCode::kBusy && stopped_;
  const Status stored =
      cancelled_ || !summary.ok()
          ? Status(summary.ok() ? Error{ErrorCode::kBusy, "cancelled"} : summary.error())
          : store_scan(*summary);
  if (stored.ok()) return events_.ended({JobState::kFinished, one_text(summary->remarks)});
  const bool lacked_room =
      (stored.error().code == ErrorCode::kIo || stored.error().code == ErrorCode::kBusy) &&
      !was_stopped &&
      (!world_.scans.room().check_disk_for(room_bytes_).ok() ||
       !world_.scans.blobs().availability().ok());
  world_.scans.remove_unwanted(row_.scan_id);
  if (cancelled_) return events_.ended({JobState::kCancelled, {}});
  if (lacked_room) return events_.ended({JobState::kQueued, stored.error().message, true});
  events_.ended(was_stopped ? JobEnd{JobState::kQueued, {}}
                            : JobEnd{JobState::kFailed, stored.error().message});
}

Status ImportJob::store_scan(const Summary& summary) {
  ScanRow scan;
  scan.id = row_.scan_id;
  scan.title = row_.title.empty() ? "import" : row_.title;
  scan.phase = ScanPhase::kFinished;
  scan.token_id = row_.token_id;
  scan.created_at_ms = scan.finished_at_ms = unix_now_ms();
  for (const std::string& remark : summary.remarks) events_.log(remark);
  return world_.scans.add_imported(scan, summary.may_be_meshed);
}

}  // namespace hermite::server
