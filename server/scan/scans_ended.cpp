// The part of Scans for ended scans: how they are shown and removed.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/run/results.h"
#include "server/scan/scans.h"
#include "server/scan/stored_scan.h"
#include "server/store/unix_time.h"

namespace hermite {

namespace {

// Frame logs that are removed per hour at most: this many, or this part of all.
constexpr std::size_t kMinLogsRemoved = 10, kPartOfLogsRemoved = 10;

}  // namespace

// For a camera that was disconnected when its scan ended. Runs in the background and uses only thread-safe members.
Scans::LastMessages Scans::last_messages(const ScanRow& row, const wire::ResumeScan& request) const {
  FrameLogReader log(data_.log_folder(row.id));
  const Result<std::optional<LogRecord>> terms = log.next(), start = log.next();
  if (!terms.ok() || !start.ok() || !*terms || !*start) return Error{ErrorCode::kNotFound, "the scan has ended, and its log is gone"};
  const Result<ScanRecord> record = parse_scan_record((*terms)->payload, (*start)->payload);
  if (!record.ok()) return record.error();
  if (Status status = check_resume_token(request.resume_token, record->resume_token_sha256); !status.ok()) return status.error();
  if (row.phase != ScanPhase::kFinished)
    return Error{ErrorCode::kNotFound, std::string("the scan is ") + name_of(row.phase) + ": " + row.message};
  const auto received = static_cast<std::uint64_t>(row.frames_received);
  wire::ScanState state{wire::ScanPhase::kFinished, row.message, received, static_cast<std::uint64_t>(row.frames_processed),
                        static_cast<std::uint64_t>(row.frames_dropped)};
  read_map_counts(blobs_, row.id, state);
  Result<wire::Finished> results = read_results(blobs_, row.id);
  if (!results.ok()) return results.error();
  return std::vector<wire::ServerMessage>{wire::Resumed{received, received, received}, std::move(state), *std::move(results)};
}

Scans::Ticket Scans::when_told(const wire::ResumeScan& request, std::function<void(LastMessages)> then) {
  const Ticket ticket = next_ticket_++;
  to_be_told_[ticket] = std::move(then);
  background_([this, ticket, row = find(request.scan_id), request] {
    // Posted functions are copied; the shared pointer avoids copying the results.
    const auto messages = std::make_shared<LastMessages>(row.ok() ? last_messages(*row, request) : row.error());
    post_([this, ticket, messages] {
      if (auto waiting = to_be_told_.extract(ticket); !waiting.empty()) waiting.mapped()(std::move(*messages));
    });
  });
  return ticket;
}

Result<std::shared_ptr<Subscribers>> Scans::watch(const std::string& scan_id) {
  if (const auto running = running_.find(scan_id); running != running_.end()) return running->second->shared_subscribers();
  return shown_.watch(scan_id);
}

void Scans::forget(Ticket ticket) { to_be_told_.erase(ticket); }

Status Scans::remove(const std::string& scan_id) {
  if (running_.contains(scan_id)) return Error{ErrorCode::kBusy, "scan " + scan_id + " is running"};
  const Result<ScanRow> row = find(scan_id);
  if (!row.ok()) return row.error();
  if (row->phase == ScanPhase::kRunning)
    return Error{ErrorCode::kBusy, "scan " + scan_id + " is to go on: cancel its job, or try again later"};
  if (Status status = remove_files_of_scan(storage_, scan_id); !status.ok()) return status;
  shown_.forget(scan_id);
  unstored_ends_.forget(scan_id);
  return unstored_removals_.make(*row);
}

// Present viewers see the new title when they reconnect.
const LiveScan* Scans::running(const std::string& scan_id) const {
  const auto running = running_.find(scan_id);
  return running == running_.end() ? nullptr : running->second.get();
}

Status Scans::rename(const std::string& scan_id, const std::string& title) {
  if (Status renamed = store_.scans.rename(scan_id, title); !renamed.ok()) return renamed;
  if (ScanRow* const ended = unstored_ends_.find(scan_id)) ended->title = title;
  if (const auto running = running_.find(scan_id); running != running_.end()) running->second->shared_subscribers()->rename(title);
  shown_.forget(scan_id);
  return Done{};
}

Status Scans::end(const std::string& scan_id) {
  const Result<ScanRow> row = find(scan_id);
  if (!row.ok()) return row.error();
  const auto running = running_.find(scan_id);
  if (running == running_.end() || !running->second->takes_frames())
    return Error{ErrorCode::kBusy, "scan " + scan_id + " takes no frames any more: there is nothing to stop"};
  const Result<std::vector<JobRow>> jobs = store_.jobs.in_state(JobState::kRunning);
  if (!jobs.ok()) return jobs.error();
  for (const JobRow& job : *jobs)
    if (job.scan_id == scan_id) return Error{ErrorCode::kBusy, "scan " + scan_id + " is made by job " + job.id + ": cancel that"};
  running->second->end_with({ErrorCode::kBusy, "stopped from the viewer"});
  return Done{};
}

Result<std::uint64_t> Scans::size_of_result(const std::string& scan_id, const std::string& name) {
  if (Result<ScanRow> row = find(scan_id); !row.ok()) return row.error();
  const bool running = running_.contains(scan_id);
  const Result<std::uint64_t> size_bytes = running ? Error{ErrorCode::kNotFound, ""} : blobs_.size_bytes(scan_id, name);
  if (size_bytes.ok() || size_bytes.error().code != ErrorCode::kNotFound) return size_bytes;
  return Error{ErrorCode::kNotFound, "scan " + scan_id + " has no " + name + (running ? " yet" : "")};
}

// Looks at every folder rather than every row, since the store lists only the newest scans.
void Scans::remove_old_logs(std::int64_t now_ms) {
  old_logs_removed_at_ = LiveScan::Clock::now();
  if (options_.keep_log_days == 0) return;
  background_([this, now_ms] {
    Result<std::vector<std::string>> ids = data_.logged_scan_ids();
    if (!ids.ok()) return spdlog::warn("{}", ids.error().message);
    post_([this, now_ms, ids = *std::move(ids)] { remove_old_logs_of(ids, now_ms); });
  });
}

// Removes a limited number per hour, so that a wrong clock or setting can be noticed in time.
void Scans::remove_old_logs_of(const std::vector<std::string>& scan_ids, std::int64_t now_ms) {
  std::size_t room = std::max<std::size_t>(kMinLogsRemoved, scan_ids.size() / kPartOfLogsRemoved);
  const std::int64_t oldest_ms = now_ms - options_.keep_log_days * kDay_ms;
  for (const std::string& id : scan_ids) {
    const Result<ScanRow> row = store_.scans.find(id);
    if (!row.ok() || row->phase == ScanPhase::kRunning || row->to_be_rebuilt || row->finished_at_ms >= oldest_ms) continue;
    if (room-- == 0) return;
    spdlog::info("scan {}: its frames are removed, they are older than {} days", id, options_.keep_log_days);
    background_([&data = data_, id] {
      if (Status status = data.remove_log_folder(id); !status.ok()) spdlog::warn("{}", status.error().message);
    });
  }
}

}  // namespace hermite
