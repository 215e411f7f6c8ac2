#include "server/exports/exports.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "core/base/check.h"
#include "core/output/ply.h"
#include "server/exports/export_files.h"
#include "server/exports/scan_edits_file.h"

namespace hermite::server {

Exports::Exports(Blobs& blobs, Hooks hooks)
    : blobs_(blobs), hooks_(std::move(hooks)), queue_(blobs, hooks_) {}

Result<ScanRow> Exports::find_ended(const std::string& scan_id) const {
  Result<ScanRow> row = hooks_.find(scan_id);
  if (row.ok() && row->phase == ScanPhase::kRunning)
    return Error{
        ErrorCode::kBusy,
        fmt::format("scan {} is running: exports are made of scans that have ended", scan_id)};
  return row;
}

ExportState Exports::state_of(const std::string& scan_id, const ExportSpec& spec,
                              std::optional<std::uint64_t> size_bytes) const {
  const ExportQueue::Known known = queue_.find({scan_id, spec.name()});
  if (size_bytes && known.phase != ExportPhase::kRunning)
    return {spec.offer, spec.shape, spec.other_scan_id, ExportPhase::kReady, *size_bytes, 0, ""};
  return {spec.offer, spec.shape, spec.other_scan_id, known.phase, 0, known.done, known.message};
}

// Exports with options that are ready, queued, running or failed.
std::vector<ExportSpec> Exports::shaped_exports(const std::string& scan_id,
                                                const std::vector<BlobInfo>& blobs) const {
  std::map<std::string, ExportSpec> found;
  for (const BlobInfo& blob : blobs)
    if (const ExportSpec spec = shaped_export_of_file(blob.name); spec.offer)
      found[spec.name()] = spec;
  for (const std::string& name : queue_.names(scan_id))
    if (const Result<ExportSpec> spec = export_spec_named(name);
        spec.ok() && !spec->shape.is_plain())
      found[name] = *spec;
  std::vector<ExportSpec> specs;
  for (const auto& [name, spec] : found) specs.push_back(spec);
  return specs;
}

Result<std::vector<ExportState>> Exports::list(const std::string& scan_id) {
  if (const Result<ScanRow> row = find_ended(scan_id); !row.ok()) return row.error();
  const Result<std::vector<BlobInfo>> blobs = blobs_.list(scan_id);
  if (!blobs.ok()) return blobs.error();
  const auto find = [&blobs](std::string_view name) {
    return std::find_if(blobs->begin(), blobs->end(),
                        [name](const BlobInfo& info) { return info.name == name; });
  };
  const auto is_there = [&](std::string_view name) { return find(name) != blobs->end(); };
  std::vector<ExportSpec> specs;
  for (const ExportOffer& offer : export_offers()) {
    if (offer.name == kEditedCloud && !is_there(kEditsFile) && !is_there(offer.file)) continue;
    const std::vector<std::string> sources = sources_of(offer);
    if (is_there(offer.file) || std::any_of(sources.begin(), sources.end(), is_there))
      specs.push_back({&offer, {}});
  }
  for (const ExportSpec& spec : shaped_exports(scan_id, *blobs)) specs.push_back(spec);
  std::vector<ExportState> states;
  for (const ExportSpec& spec : specs) {
    const auto blob = find(spec.file());
    states.push_back(state_of(
        scan_id, spec,
        blob == blobs->end() ? std::nullopt : std::optional<std::uint64_t>(blob->size_bytes)));
  }
  return states;
}

Result<ExportState> Exports::state(const std::string& scan_id, const std::string& name) {
  if (const Result<ScanRow> row = find_ended(scan_id); !row.ok()) return row.error();
  const Result<ExportSpec> spec = export_spec_named(name);
  if (!spec.ok()) return spec.error();
  return stored_state(scan_id, *spec);
}

Result<ExportState> Exports::stored_state(const std::string& scan_id,
                                          const ExportSpec& spec) const {
  const Result<std::uint64_t> size_bytes = blobs_.size_bytes(scan_id, spec.file());
  if (!size_bytes.ok() && size_bytes.error().code != ErrorCode::kNotFound)
    return size_bytes.error();
  return state_of(scan_id, spec,
                  size_bytes.ok() ? std::optional<std::uint64_t>(*size_bytes) : std::nullopt);
}

Status Exports::check_shaped(const std::string& scan_id, const ExportSpec& spec) const {
  if (spec.shape.is_plain()) return Done{};
  const Result<std::vector<BlobInfo>> blobs = blobs_.list(scan_id);
  if (!blobs.ok()) return blobs.error();
  const std::vector<ExportSpec> there = shaped_exports(scan_id, *blobs);
  const bool is_there = std::any_of(
      there.begin(), there.end(), [&](const ExportSpec& one) { return one.name() == spec.name(); });
  if (is_there || there.size() < kMaxShapedExports) return Done{};
  return Error{
      ErrorCode::kBusy,
      fmt::format(
          "scan {} has {} exports with options, of at most {}: remove one that nobody needs",
          scan_id, there.size(), kMaxShapedExports)};
}

Status Exports::check_source(const std::string& scan_id, const ExportOffer& format) const {
  const Result<std::uint64_t> size_bytes = source_bytes(blobs_, scan_id, format);
  if (!size_bytes.ok()) return size_bytes.error();
  if (format.kind != ExportKind::kPath && *size_bytes == output::format_ply({}).size())
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("the cloud of scan {} has no points: there is nothing to export", scan_id)};
  return Done{};
}

Status Exports::add(const ScanRow& scan, const ExportSpec& spec, const ExportRequest& asker,
                    bool is_requested) {
  std::int64_t other_ended_at_ms = 0;
  for (const Status& status : {check_source(scan.id, *spec.offer), check_shaped(scan.id, spec)})
    if (!status.ok()) return status;
  if (spec.is_comparison()) {
    const Result<ScanRow> other = find_ended(spec.other_scan_id);
    if (!other.ok()) return other.error();
    other_ended_at_ms = other->finished_at_ms;
    for (const Status& status :
         {check_source(spec.other_scan_id, *spec.offer), check_comparisons(scan.id, spec)})
      if (!status.ok()) return status;
  }
  if (Status status = check_share(kExportShare, queue_.taken_by(asker.token_id), asker.is_admin,
                                  "exports that wait or are made");
      !status.ok())
    return status;
  queue_.add({scan.id, spec, asker.token_id, is_requested, scan.finished_at_ms, other_ended_at_ms});
  return Done{};
}

Status Exports::request(const ExportRequest& request) {
  const Result<ScanRow> row = find_ended(request.scan_id);
  if (!row.ok()) return row.error();
  const Result<ExportState> now = state(request.scan_id, request.format);
  return now.ok() ? request_spec(*row, {now->format, now->shape}, request) : Status(now.error());
}

Status Exports::request_spec(const ScanRow& scan, const ExportSpec& spec,
                             const ExportRequest& asker) {
  const Result<ExportState> now = stored_state(scan.id, spec);
  if (!now.ok()) return now.error();
  const ExportKey key{scan.id, spec.name()};
  queue_.mark_requested(key);
  const bool there = now->phase == ExportPhase::kReady || now->phase == ExportPhase::kQueued ||
                     now->phase == ExportPhase::kRunning;
  if (there) return Done{};
  if (now->format->is_result)
    return Error{ErrorCode::kNotFound,
                 fmt::format("scan {} has no {}", scan.id, now->format->file)};
  if (queue_.is_stopping()) return Error{ErrorCode::kBusy, "the server is stopping"};
  if (queue_.is_being_dropped(key))
    return Error{ErrorCode::kBusy, "it is just being stopped; try again in a moment"};
  return add(scan, spec, asker, true);
}

void Exports::make_mesh(const ScanRow& scan) {
  const ExportOffer* const format = find_export_offer(kViewerMesh);
  CHECK(format, "the viewer's mesh is a format");
  if (queue_.is_stopping() || queue_.is_waiting({scan.id, std::string(format->name)})) return;
  if (const Status added =
          add(scan, {format, {}}, {scan.id, std::string(kViewerMesh), scan.token_id, false}, false);
      !added.ok())
    spdlog::info("scan {}: its mesh is not made by itself: {}", scan.id, added.error().message);
}

Status Exports::remove(const std::string& scan_id, const std::string& name) {
  const Result<ExportState> now = state(scan_id, name);
  if (!now.ok()) return now.error();
  if (now->format->is_result)
    return Error{ErrorCode::kInvalidArgument,
                 name + " is a result of the scan and goes with it alone"};
  return remove_spec(scan_id, *now);
}

Status Exports::remove_spec(const std::string& scan_id, const ExportState& now) {
  const ExportSpec spec{now.format, now.shape, now.other_scan_id};
  if (now.phase == ExportPhase::kMissing)
    return Error{ErrorCode::kNotFound,
                 fmt::format("scan {} has no {} and none is being made", scan_id, spec.file())};
  queue_.drop({scan_id, spec.name()});
  return now.phase == ExportPhase::kReady ? remove_export(blobs_, scan_id, spec) : Status(Done{});
}

}  // namespace hermite::server
