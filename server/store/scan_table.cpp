#include "server/store/scan_table.h"

#include <sstream>

#include "server/store/table_tools.h"

namespace hermite::server {

namespace {

constexpr const char* kScanColumns =
    "id, title, phase, words, width, height, fx, fy, cx, cy, depth_units_per_metre, "
    "frames_received, frames_processed, frames_dropped, "
    "created_at_ms, finished_at_ms, token_id, to_be_rebuilt, tags";
const std::string kSelectScans = std::string("SELECT ") + kScanColumns + " FROM scans ";

ScanPhase phase_of(const std::string& name) {
  for (const ScanPhase phase : {ScanPhase::kRunning, ScanPhase::kFinished, ScanPhase::kFailed})
    if (name == name_of(phase)) return phase;
  return ScanPhase::kInterrupted;
}

std::string lines_of(const std::vector<std::string>& tags) {
  std::string lines;
  for (const std::string& tag : tags) lines += (lines.empty() ? "" : "\n") + tag;
  return lines;
}

std::vector<std::string> tags_of(const std::string& lines) {
  std::vector<std::string> tags;
  std::istringstream from(lines);
  for (std::string tag; std::getline(from, tag);) tags.push_back(tag);
  return tags;
}

std::vector<SqlValue> values_of(const ScanRow& row) {
  const Camera& camera = row.camera;
  return {row.id,
          row.title,
          name_of(row.phase),
          row.message,
          camera.width,
          camera.height,
          camera.fx,
          camera.fy,
          camera.cx,
          camera.cy,
          camera.depth_units_per_metre,
          row.frames_received,
          row.frames_processed,
          row.frames_dropped,
          row.created_at_ms,
          row.finished_at_ms,
          row.token_id,
          row.to_be_rebuilt,
          lines_of(row.tags)};
}

ScanRow scan_row_of(const SqlRow& values) {
  RowReader next(values);
  ScanRow row;
  row.id = next.text();
  row.title = next.text();
  row.phase = phase_of(next.text());
  row.message = next.text();
  row.camera.width = next.small_integer();
  row.camera.height = next.small_integer();
  row.camera.fx = next.number();
  row.camera.fy = next.number();
  row.camera.cx = next.number();
  row.camera.cy = next.number();
  row.camera.depth_units_per_metre = next.number();
  row.frames_received = next.integer();
  row.frames_processed = next.integer();
  row.frames_dropped = next.integer();
  row.created_at_ms = next.integer();
  row.finished_at_ms = next.integer();
  row.token_id = next.text();
  row.to_be_rebuilt = next.flag();
  row.tags = tags_of(next.text());
  return row;
}

Error no_scan(const std::string& id) { return {ErrorCode::kNotFound, "there is no scan " + id}; }

}  // namespace

Status ScanTable::add(const ScanRow& row) {
  return change(database_, "scan " + row.id, [&]() -> Status {
    database_.run(insertion("scans", kScanColumns), values_of(row));
    return Done{};
  });
}

Status ScanTable::update(const ScanRow& row) {
  return change(database_, "scan " + row.id, [&] {
    return changed_or(
        database_.run("UPDATE scans SET phase = $1, words = $2, frames_received = $3, "
                      "frames_processed = $4, frames_dropped = $5, "
                      "finished_at_ms = $6, to_be_rebuilt = $7 WHERE id = $8",
                      {name_of(row.phase), row.message, row.frames_received, row.frames_processed,
                       row.frames_dropped, row.finished_at_ms, row.to_be_rebuilt, row.id}),
        no_scan(row.id));
  });
}

Status ScanTable::label(const std::string& id, const ScanLabels& labels) {
  const SqlValue title = labels.title ? SqlValue(*labels.title) : SqlValue(),
                 tags = labels.tags ? SqlValue(lines_of(*labels.tags)) : SqlValue();
  return change(database_, "scan " + id, [&] {
    return changed_or(
        database_.run(
            "UPDATE scans SET title = coalesce($1, title), tags = coalesce($2, tags) WHERE id = $3",
            {title, tags, id}),
        no_scan(id));
  });
}

Result<ScanRow> ScanTable::find(const std::string& id) {
  return read(database_, [&]() -> Result<ScanRow> {
    const SqlResult result = database_.run(kSelectScans + "WHERE id = $1", {id});
    if (result.rows.empty()) return no_scan(id);
    return scan_row_of(result.rows.front());
  });
}

Status ScanTable::remove(const std::string& id) {
  return change(database_, "scan " + id, [&] {
    return changed_or(database_.run("DELETE FROM scans WHERE id = $1", {id}), no_scan(id));
  });
}

Result<std::vector<ScanRow>> ScanTable::list() {
  return read(database_, [&] {
    return rows_of(
        database_.run(kSelectScans + "ORDER BY created_at_ms DESC, id LIMIT $1", {kMaxListedScans}),
        scan_row_of);
  });
}

Result<std::vector<ScanRow>> ScanTable::list_older_than(const std::string& id) {
  const Result<ScanRow> newer = find(id);
  if (!newer.ok()) return newer.error();
  return read(database_, [&] {
    return rows_of(
        database_.run(kSelectScans + "WHERE created_at_ms < $1 OR (created_at_ms = $1 AND id > $2) "
                                     "ORDER BY created_at_ms DESC, id LIMIT $3",
                      {newer->created_at_ms, id, kMaxListedScans}),
        scan_row_of);
  });
}

Result<std::vector<ScanRow>> ScanTable::running() {
  return read(database_, [&] {
    return rows_of(
        database_.run(kSelectScans + "WHERE phase = 'running' AND id NOT IN (SELECT scan_id FROM "
                                     "jobs WHERE state IN ('queued', 'running')) "
                                     "ORDER BY created_at_ms, id"),
        scan_row_of);
  });
}

Result<std::optional<ScanRow>> ScanTable::next_to_rebuild() {
  return read(database_, [&]() -> Result<std::optional<ScanRow>> {
    const SqlResult result = database_.run(
        kSelectScans +
        "WHERE to_be_rebuilt = 1 AND phase <> 'running' ORDER BY created_at_ms, id LIMIT 1");
    return result.rows.empty() ? std::nullopt : std::optional(scan_row_of(result.rows.front()));
  });
}

Result<std::vector<std::string>> ScanTable::of_token(const std::string& token_id) {
  return read(database_, [&]() -> Result<std::vector<std::string>> {
    std::vector<std::string> ids;
    for (const SqlRow& row :
         database_.run("SELECT id FROM scans WHERE token_id = $1", {token_id}).rows)
      ids.push_back(RowReader(row).text());
    return ids;
  });
}

}  // namespace hermite::server
