// The edits of a scan: its exports are made of what they leave.
#include <utility>

#include "server/exports/exports.h"
#include "server/exports/scan_edits_file.h"

namespace hermite::server {

Result<edit::ScanEdits> Exports::edits(const std::string& scan_id) const {
  if (const Result<ScanRow> row = hooks_.find(scan_id); !row.ok()) return row.error();
  return read_edits(blobs_, scan_id);
}

// Exports are removed before the new edits are there: none is older than the edits, whatever fails
// in between.
Result<edit::ScanEdits> Exports::change_edits(const std::string& scan_id, edit::ScanEdits changed) {
  const Result<ScanRow> row = find_ended(scan_id);
  if (!row.ok()) return row.error();
  Result<edit::ScanEdits> now = read_edits(blobs_, scan_id);
  if (!now.ok() || now->version != changed.version) return now;
  if (now->edits == changed.edits) return now;
  const Result<std::vector<ExportState>> states = list(scan_id);
  if (!states.ok()) return states.error();
  for (const ExportState& state : *states) {
    const bool is_edited = !state.format->is_result && state.format->kind != ExportKind::kPath;
    if (!is_edited || state.phase == ExportPhase::kMissing) continue;
    if (const Status removed = remove_spec(scan_id, state); !removed.ok()) return removed.error();
  }
  ++changed.version;
  if (const Status put = blobs_.put(scan_id, kEditsFile, edit::format_scan_edits(changed));
      !put.ok())
    return put.error();
  make_mesh(*row);
  return changed;
}

}  // namespace hermite::server
