// The comparisons among the exports: they have two scans, and end with either.
#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>

#include "server/exports/export_files.h"
#include "server/exports/exports.h"

namespace hermite::server {

// Returns the row of the first scan, if both have ended.
Result<ScanRow> Exports::find_compared(const std::string& scan_id,
                                       const std::string& other_scan_id) {
  Result<ScanRow> row = find_ended(scan_id);
  if (!row.ok()) return row;
  if (scan_id == other_scan_id)
    return Error{ErrorCode::kInvalidArgument,
                 "a scan is compared with another one, not with itself"};
  const Result<ScanRow> other = find_ended(other_scan_id);
  if (!other.ok()) return other.error();
  return row;
}

// Of those that are ready, queued, running or failed.
std::vector<std::string> Exports::compared_scans(const std::string& scan_id,
                                                 const std::vector<BlobInfo>& blobs) const {
  std::set<std::string> others;
  for (const BlobInfo& blob : blobs)
    if (std::string other = compared_scan_of_file(blob.name); !other.empty())
      others.insert(std::move(other));
  for (const std::string& name : queue_.names(scan_id))
    if (std::string other = compared_scan_of_file(name + ".json"); !other.empty())
      others.insert(std::move(other));
  return {others.begin(), others.end()};
}

Status Exports::check_comparisons(const std::string& scan_id, const ExportSpec& spec) const {
  const Result<std::vector<BlobInfo>> blobs = blobs_.list(scan_id);
  if (!blobs.ok()) return blobs.error();
  const std::vector<std::string> others = compared_scans(scan_id, *blobs);
  const bool is_there = std::find(others.begin(), others.end(), spec.other_scan_id) != others.end();
  if (is_there || others.size() < kMaxComparisons) return Done{};
  return Error{
      ErrorCode::kBusy,
      fmt::format("scan {} has {} comparisons, of at most {}: remove one that nobody needs",
                  scan_id, others.size(), kMaxComparisons)};
}

Result<std::vector<ExportState>> Exports::list_comparisons(const std::string& scan_id) {
  if (const Result<ScanRow> row = find_ended(scan_id); !row.ok()) return row.error();
  const Result<std::vector<BlobInfo>> blobs = blobs_.list(scan_id);
  if (!blobs.ok()) return blobs.error();
  std::vector<ExportState> states;
  for (const std::string& other : compared_scans(scan_id, *blobs)) {
    const ExportSpec spec = comparison_with(other);
    if (const Result<ScanRow> row = hooks_.find(other);
        !row.ok() && row.error().code == ErrorCode::kNotFound) {
      queue_.forget_failure({scan_id, spec.name()});
      if (const Status removed = remove_export(blobs_, scan_id, spec); !removed.ok())
        spdlog::warn("scan {}: {}", scan_id, removed.error().message);
      continue;
    }
    Result<ExportState> state = stored_state(scan_id, spec);
    if (!state.ok()) return state.error();
    states.push_back(*std::move(state));
  }
  return states;
}

Result<ExportState> Exports::comparison(const std::string& scan_id,
                                        const std::string& other_scan_id) {
  const Result<ScanRow> row = find_compared(scan_id, other_scan_id);
  return row.ok() ? stored_state(scan_id, comparison_with(other_scan_id)) : row.error();
}

Status Exports::request_comparison(const ExportRequest& request, const std::string& other_scan_id) {
  const Result<ScanRow> row = find_compared(request.scan_id, other_scan_id);
  return row.ok() ? request_spec(*row, comparison_with(other_scan_id), request)
                  : Status(row.error());
}

Status Exports::remove_comparison(const std::string& scan_id, const std::string& other_scan_id) {
  const Result<ExportState> now = comparison(scan_id, other_scan_id);
  return now.ok() ? remove_spec(scan_id, *now) : Status(now.error());
}

void Exports::forget_comparisons_with(const std::string& scan_id) {
  const Result<std::vector<BlobInfo>> blobs = blobs_.list(scan_id);
  if (!blobs.ok()) {
    spdlog::warn("scan {}: {}", scan_id, blobs.error().message);
    return;
  }
  for (const BlobInfo& blob : *blobs) {
    const std::string first = first_scan_of_mark(blob.name),
                      second = compared_scan_of_file(blob.name);
    Status removed = Done{};
    if (!first.empty()) removed = remove_export(blobs_, first, comparison_with(scan_id));
    if (!second.empty()) removed = remove_export(blobs_, scan_id, comparison_with(second));
    if (!removed.ok()) spdlog::warn("scan {}: {}", scan_id, removed.error().message);
  }
}

}  // namespace hermite::server
