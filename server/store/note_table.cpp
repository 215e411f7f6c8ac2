#include "server/store/note_table.h"

#include <fmt/core.h>

#include "server/store/table_tools.h"

namespace hermite::server {

namespace {

constexpr const char* kNoteColumns =
    "id, scan_id, x, y, z, eye_x, eye_y, eye_z, target_x, target_y, target_z, text, version, "
    "created_at_ms, changed_at_ms";

using Position = std::array<double, 3>;

// Appends three NULLs for no position.
void append(std::vector<SqlValue>& values, const Position* position_m) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    values.push_back(position_m ? SqlValue((*position_m)[axis]) : SqlValue());
}

Position position_of(RowReader& next) {
  const double x = next.number(), y = next.number();
  return {x, y, next.number()};
}

std::vector<SqlValue> values_of(const NoteRow& row) {
  std::vector<SqlValue> values = {row.id, row.scan_id};
  append(values, &row.position_m);
  append(values, row.view ? &row.view->position_m : nullptr);
  append(values, row.view ? &row.view->target_m : nullptr);
  values.emplace_back(row.text);
  for (const std::int64_t value : {row.version, row.created_at_ms, row.changed_at_ms})
    values.emplace_back(value);
  return values;
}

NoteRow note_row_of(const SqlRow& values) {
  RowReader next(values);
  NoteRow row;
  row.id = next.text();
  row.scan_id = next.text();
  row.position_m = position_of(next);
  if (next.is_null()) {
    next.skip(6);
  } else {
    const Position eye_m = position_of(next);
    row.view = NoteView{eye_m, position_of(next)};
  }
  row.text = next.text();
  row.version = next.integer();
  row.created_at_ms = next.integer();
  row.changed_at_ms = next.integer();
  return row;
}

Result<NoteRow> find_note(Database& database, const std::string& scan_id, const std::string& id) {
  const SqlResult result = database.run(
      std::string("SELECT ") + kNoteColumns + " FROM notes WHERE scan_id = $1 AND id = $2",
      {scan_id, id});
  if (result.rows.empty())
    return Error{ErrorCode::kNotFound, fmt::format("scan {} has no note {}", scan_id, id)};
  return note_row_of(result.rows.front());
}

}  // namespace

Status NoteTable::add(const NoteRow& row) {
  return change(database_, "note " + row.id, [&]() -> Status {
    Status status = check_room_in_scan(database_, row.scan_id, "notes", kMaxNotesPerScan);
    if (status.ok()) database_.run(insertion("notes", kNoteColumns), values_of(row));
    return status;
  });
}

Result<std::vector<NoteRow>> NoteTable::of_scan(const std::string& scan_id) {
  return read(database_, [&] {
    return rows_of(database_.run(std::string("SELECT ") + kNoteColumns +
                                     " FROM notes WHERE scan_id = $1 ORDER BY created_at_ms, id",
                                 {scan_id}),
                   note_row_of);
  });
}

Result<NoteOutcome> NoteTable::change_text(const NoteRow& row) {
  return change(database_, "note " + row.id, [&]() -> Result<NoteOutcome> {
    Result<NoteRow> note = find_note(database_, row.scan_id, row.id);
    if (!note.ok()) return note.error();
    if (note->version != row.version) return NoteOutcome{false, *std::move(note)};
    note->text = row.text;
    note->version += 1;
    note->changed_at_ms = row.changed_at_ms;
    database_.run(
        "UPDATE notes SET text = $1, version = $2, changed_at_ms = $3 WHERE scan_id = $4 AND id = "
        "$5",
        {note->text, note->version, note->changed_at_ms, note->scan_id, note->id});
    return NoteOutcome{true, *std::move(note)};
  });
}

Result<NoteOutcome> NoteTable::remove(const std::string& scan_id, const std::string& id,
                                      std::int64_t version) {
  return change(database_, "note " + id, [&]() -> Result<NoteOutcome> {
    Result<NoteRow> note = find_note(database_, scan_id, id);
    if (!note.ok()) return note.error();
    if (note->version != version) return NoteOutcome{false, *std::move(note)};
    database_.run("DELETE FROM notes WHERE scan_id = $1 AND id = $2", {scan_id, id});
    return NoteOutcome{true, *std::move(note)};
  });
}

}  // namespace hermite::server
