// The part of SqliteStore for notes.
#include <sqlite3.h>

#include "server/store/sqlite_connection.h"

namespace hermite {

namespace {

constexpr const char* kNoteColumns =
    "id, scan_id, x, y, z, eye_x, eye_y, eye_z, target_x, target_y, target_z, text, version, created_at_ms, changed_at_ms";

std::array<double, 3> position_at(const SQLite::Statement& query, int column) {
  return {query.getColumn(column).getDouble(), query.getColumn(column + 1).getDouble(), query.getColumn(column + 2).getDouble()};
}

NoteRow note_row_of(const SQLite::Statement& query) {
  NoteRow row;
  row.id = query.getColumn(0).getString();
  row.scan_id = query.getColumn(1).getString();
  row.position_m = position_at(query, 2);
  if (!query.getColumn(5).isNull()) row.view = NoteView{position_at(query, 5), position_at(query, 8)};
  row.text = query.getColumn(11).getString();
  row.version = query.getColumn(12).getInt64();
  row.created_at_ms = query.getColumn(13).getInt64();
  row.changed_at_ms = query.getColumn(14).getInt64();
  return row;
}

// Binds three NULLs for no position.
void bind_position(SQLite::Statement& statement, int& column, const std::array<double, 3>* position_m) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (position_m)
      statement.bind(++column, (*position_m)[axis]);
    else
      statement.bind(++column);
}

void insert_note(SQLite::Database& database, const NoteRow& row) {
  SQLite::Statement insert(database, std::string("INSERT INTO notes(") + kNoteColumns + ") VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  int column = 0;
  for (const std::string& text : {row.id, row.scan_id}) insert.bind(++column, text);
  bind_position(insert, column, &row.position_m);
  bind_position(insert, column, row.view ? &row.view->position_m : nullptr);
  bind_position(insert, column, row.view ? &row.view->target_m : nullptr);
  insert.bind(++column, row.text);
  for (const std::int64_t value : {row.version, row.created_at_ms, row.changed_at_ms}) insert.bind(++column, value);
  insert.exec();
}

Result<NoteRow> find_note(SQLite::Database& database, const std::string& scan_id, const std::string& id) {
  SQLite::Statement query(database, std::string("SELECT ") + kNoteColumns + " FROM notes WHERE scan_id = ? AND id = ?");
  query.bind(1, scan_id);
  query.bind(2, id);
  if (!query.executeStep()) return Error{ErrorCode::kNotFound, "scan " + scan_id + " has no note " + id};
  return note_row_of(query);
}

}  // namespace

Status SqliteStore::add_note(const NoteRow& row) try {
  SQLite::Database& database = impl_->database;
  SQLite::Statement scan(database, "SELECT (SELECT count(*) FROM notes WHERE scan_id = ?1) FROM scans WHERE id = ?1");
  scan.bind(1, row.scan_id);
  if (!scan.executeStep()) return Error{ErrorCode::kNotFound, "there is no scan " + row.scan_id};
  if (scan.getColumn(0).getInt() >= kMaxNotesPerScan)
    return Error{ErrorCode::kBusy, "a scan may have at most " + std::to_string(kMaxNotesPerScan) + " notes"};
  scan.reset();
  insert_note(database, row);
  return Done{};
} catch (const SQLite::Exception& failure) {
  if (failure.getErrorCode() == SQLITE_CONSTRAINT) return Error{ErrorCode::kInvalidArgument, "note " + row.id + ": " + failure.what()};
  return database_error(failure);
}

Result<std::vector<NoteRow>> SqliteStore::list_notes(const std::string& scan_id) try {
  SQLite::Statement query(impl_->database,
                          std::string("SELECT ") + kNoteColumns + " FROM notes WHERE scan_id = ? ORDER BY created_at_ms, id");
  query.bind(1, scan_id);
  std::vector<NoteRow> rows;
  while (query.executeStep()) rows.push_back(note_row_of(query));
  return rows;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<NoteOutcome> SqliteStore::change_note(const NoteRow& row) try {
  SQLite::Transaction transaction(impl_->database, SQLite::TransactionBehavior::IMMEDIATE);
  Result<NoteRow> note = find_note(impl_->database, row.scan_id, row.id);
  if (!note.ok()) return note.error();
  if (note->version != row.version) return NoteOutcome{false, *std::move(note)};
  note->text = row.text;
  note->version += 1;
  note->changed_at_ms = row.changed_at_ms;
  SQLite::Statement change(impl_->database, "UPDATE notes SET text = ?, version = ?, changed_at_ms = ? WHERE scan_id = ? AND id = ?");
  change.bind(1, note->text);
  change.bind(2, note->version);
  change.bind(3, note->changed_at_ms);
  change.bind(4, note->scan_id);
  change.bind(5, note->id);
  change.exec();
  transaction.commit();
  return NoteOutcome{true, *std::move(note)};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<NoteOutcome> SqliteStore::remove_note(const std::string& scan_id, const std::string& id, std::int64_t version) try {
  SQLite::Transaction transaction(impl_->database, SQLite::TransactionBehavior::IMMEDIATE);
  Result<NoteRow> note = find_note(impl_->database, scan_id, id);
  if (!note.ok()) return note.error();
  if (note->version != version) return NoteOutcome{false, *std::move(note)};
  SQLite::Statement change(impl_->database, "DELETE FROM notes WHERE scan_id = ? AND id = ?");
  change.bind(1, scan_id);
  change.bind(2, id);
  change.exec();
  transaction.commit();
  return NoteOutcome{true, *std::move(note)};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

}  // namespace hermite
