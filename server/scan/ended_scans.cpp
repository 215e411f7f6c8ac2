#include "server/scan/ended_scans.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/log/frame_log_reader.h"
#include "core/run/results.h"
#include "server/scan/scan_record.h"
#include "server/scan/stored_scan.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

// Frame logs that are removed per hour at most: this many, or this part of all.
constexpr std::chrono::hours kOldLogsPeriod(1);
constexpr std::size_t kMinLogsRemoved = 10, kPartOfLogsRemoved = 10;

}  // namespace

// For a camera that was disconnected when its scan ended. Runs in the background and uses only
// thread-safe members.
EndedScans::LastMessages EndedScans::last_messages(const ScanRow& row,
                                                   const wire::ResumeScan& request) const {
  frame_log::FrameLogReader log(log_folder(row.id));
  const Result<std::optional<frame_log::LogRecord>> terms = log.next(), start = log.next();
  if (!terms.ok() || !start.ok() || !*terms || !*start)
    return Error{ErrorCode::kNotFound, "the scan has ended, and its log is gone"};
  const Result<ScanRecord> record = parse_scan_record((*terms)->payload, (*start)->payload);
  if (!record.ok()) return record.error();
  if (Status status = check_resume_token(request.resume_token, record->resume_token_sha256);
      !status.ok())
    return status.error();
  if (row.phase != ScanPhase::kFinished)
    return Error{ErrorCode::kNotFound,
                 fmt::format("the scan is {}: {}", name_of(row.phase), row.message)};
  const auto received = static_cast<std::uint64_t>(row.frames_received);
  wire::ScanState state{wire::ScanPhase::kFinished, row.message, received,
                        static_cast<std::uint64_t>(row.frames_processed),
                        static_cast<std::uint64_t>(row.frames_dropped)};
  read_map_counts(storage_.blobs, row.id, state);
  Result<wire::Finished> results = read_results(storage_.blobs, row.id);
  if (!results.ok()) return results.error();
  return std::vector<wire::ServerMessage>{wire::Resumed{received, received, received},
                                          std::move(state), *std::move(results)};
}

EndedScans::Ticket EndedScans::when_told(const wire::ResumeScan& request,
                                         std::function<void(LastMessages)> then) {
  const Ticket ticket = next_ticket_++;
  to_be_told_[ticket] = std::move(then);
  threads_.background([this, ticket, row = rows_.find(request.scan_id), request] {
    // Posted functions are copied; the shared pointer avoids copying the results.
    const auto messages =
        std::make_shared<LastMessages>(row.ok() ? last_messages(*row, request) : row.error());
    threads_.network([this, ticket, messages] {
      if (auto waiting = to_be_told_.extract(ticket); !waiting.empty())
        waiting.mapped()(std::move(*messages));
    });
  });
  return ticket;
}

void EndedScans::forget(Ticket ticket) { to_be_told_.erase(ticket); }

Result<std::uint64_t> EndedScans::size_of_result(const std::string& scan_id,
                                                 const std::string& name) {
  if (Result<ScanRow> row = rows_.find(scan_id); !row.ok()) return row.error();
  const bool running = running_.contains(scan_id);
  const Result<std::uint64_t> size_bytes =
      running ? Error{ErrorCode::kNotFound, ""} : storage_.blobs.size_bytes(scan_id, name);
  if (size_bytes.ok() || size_bytes.error().code != ErrorCode::kNotFound) return size_bytes;
  return Error{ErrorCode::kNotFound,
               fmt::format("scan {} has no {}{}", scan_id, name, running ? " yet" : "")};
}

// Looks at every folder rather than every row, since the store lists only the newest scans.
void EndedScans::tick(std::chrono::steady_clock::time_point now, std::int64_t now_ms) {
  if (old_logs_removed_at_ && now - *old_logs_removed_at_ < kOldLogsPeriod) return;
  old_logs_removed_at_ = now;
  if (keep_log_days_ == 0) return;
  threads_.background([this, now_ms] {
    Result<std::vector<std::string>> ids = storage_.data.logged_scan_ids();
    if (!ids.ok()) return spdlog::warn("{}", ids.error().message);
    threads_.network([this, now_ms, ids = *std::move(ids)] { remove_old_logs_of(ids, now_ms); });
  });
}

// Removes a limited number per hour, so that a wrong clock or setting can be noticed in time.
void EndedScans::remove_old_logs_of(const std::vector<std::string>& scan_ids, std::int64_t now_ms) {
  std::size_t room = std::max<std::size_t>(kMinLogsRemoved, scan_ids.size() / kPartOfLogsRemoved);
  const std::int64_t oldest_ms = now_ms - keep_log_days_ * kDay_ms;
  for (const std::string& id : scan_ids) {
    const Result<ScanRow> row = storage_.store.scans.find(id);
    if (!row.ok() || row->phase == ScanPhase::kRunning || row->to_be_rebuilt ||
        row->finished_at_ms >= oldest_ms)
      continue;
    if (room-- == 0) return;
    spdlog::info("scan {}: its frames are removed, they are older than {} days", id,
                 keep_log_days_);
    threads_.background([&data = storage_.data, id] {
      if (Status status = data.remove_log_folder(id); !status.ok())
        spdlog::warn("{}", status.error().message);
    });
  }
}

}  // namespace hermite::server
