#include "server/store/sqlite_store.h"

#include <sqlite3.h>
#include <sys/stat.h>

#include <filesystem>
#include <system_error>

#include "server/store/migrations.h"
#include "server/store/sqlite_connection.h"
#include "server/store/sqlite_reader.h"

namespace hermite {

namespace {

constexpr const char* kScanColumns =
    "id, title, phase, words, width, height, fx, fy, cx, cy, depth_units_per_metre, frames_received, frames_processed, frames_dropped, "
    "created_at_ms, finished_at_ms, token_id, to_be_rebuilt";

ScanPhase phase_of(const std::string& name) {
  for (const ScanPhase phase : {ScanPhase::kRunning, ScanPhase::kFinished, ScanPhase::kFailed})
    if (name == name_of(phase)) return phase;
  return ScanPhase::kInterrupted;
}

ScanRow scan_row_of(const SQLite::Statement& query) {
  ScanRow row;
  row.id = query.getColumn(0).getString();
  row.title = query.getColumn(1).getString();
  row.phase = phase_of(query.getColumn(2).getString());
  row.message = query.getColumn(3).getString();
  row.camera.width = query.getColumn(4).getInt();
  row.camera.height = query.getColumn(5).getInt();
  row.camera.fx = query.getColumn(6).getDouble();
  row.camera.fy = query.getColumn(7).getDouble();
  row.camera.cx = query.getColumn(8).getDouble();
  row.camera.cy = query.getColumn(9).getDouble();
  row.camera.depth_units_per_metre = query.getColumn(10).getDouble();
  row.frames_received = query.getColumn(11).getInt64();
  row.frames_processed = query.getColumn(12).getInt64();
  row.frames_dropped = query.getColumn(13).getInt64();
  row.created_at_ms = query.getColumn(14).getInt64();
  row.finished_at_ms = query.getColumn(15).getInt64();
  row.token_id = query.getColumn(16).getString();
  row.to_be_rebuilt = query.getColumn(17).getInt() != 0;
  return row;
}

std::vector<ScanRow> rows_of(SQLite::Statement& query) {
  std::vector<ScanRow> rows;
  while (query.executeStep()) rows.push_back(scan_row_of(query));
  return rows;
}

// A server that ends normally leaves no WAL. If there is one, the previous server crashed, perhaps with its machine.
bool ended_uncleanly(const std::string& path) {
  std::error_code error;
  const std::uintmax_t log_bytes = std::filesystem::file_size(path + "-wal", error);
  return !error && log_bytes > 0;
}

// SQLite gives its other files the mode of the first one. The mode of files of another owner cannot be changed here,
// but the folder is closed to others (data_directory.h).
void make_files_private(const std::string& path) {
  for (const char* ending : {"", "-wal", "-shm"})
    if (struct stat status{}; stat((path + ending).c_str(), &status) == 0 && (status.st_mode & 0077) != 0)
      chmod((path + ending).c_str(), 0600);
}

SetupError damaged(const std::string& path, const std::string& found) {
  return SetupError({ErrorCode::kCorruptData, "the database " + path + " is damaged (" + found +
                                                  "): restore a backup, or move it away; the scans' files are not in it"});
}

void check_whole(SQLite::Database& database, const std::string& path) {
  const std::string found = database.execAndGet("PRAGMA quick_check(1)").getString();
  if (found != "ok") throw damaged(path, found);
}

}  // namespace

Error database_error(const SQLite::Exception& failure) { return {ErrorCode::kIo, std::string("database: ") + failure.what()}; }

SqliteStore::Impl::Impl(const std::string& path) : database(path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE) {
  database.setBusyTimeout(5000);
  for (const char* setting : {"trusted_schema = OFF", "cell_size_check = ON", "foreign_keys = ON"})
    database.exec(std::string("PRAGMA ") + setting);
}

SqliteStore::SqliteStore(const std::string& path) : path_(path) {
  try {
    const bool unclean = ended_uncleanly(path);
    impl_ = std::make_unique<Impl>(path);
    make_files_private(path);
    if (unclean) check_whole(impl_->database, path);
    migrate(impl_->database, path);
    // Only now, so that a database that was refused above stays unchanged.
    for (const char* setting : {"journal_mode = WAL", "synchronous = FULL", "journal_size_limit = 67108864"})
      impl_->database.exec(std::string("PRAGMA ") + setting);
  } catch (const SQLite::Exception& failure) {
    if (failure.getErrorCode() == SQLITE_CORRUPT) throw damaged(path, failure.what());
    throw SetupError({ErrorCode::kIo, "opening the database " + path + ": " + failure.what()});
  }
}

SqliteStore::~SqliteStore() = default;

Status SqliteStore::add(const ScanRow& row) try {
  SQLite::Statement insert(impl_->database,
                           std::string("INSERT INTO scans(") + kScanColumns + ") VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  int column = 0;
  for (const std::string& text : {row.id, row.title, std::string(name_of(row.phase)), row.message}) insert.bind(++column, text);
  for (const int side : {row.camera.width, row.camera.height}) insert.bind(++column, side);
  for (const double value : {row.camera.fx, row.camera.fy, row.camera.cx, row.camera.cy, row.camera.depth_units_per_metre})
    insert.bind(++column, value);
  for (const std::int64_t value : {row.frames_received, row.frames_processed, row.frames_dropped, row.created_at_ms, row.finished_at_ms})
    insert.bind(++column, value);
  insert.bind(++column, row.token_id);
  insert.bind(++column, row.to_be_rebuilt ? 1 : 0);
  insert.exec();
  return Done{};
} catch (const SQLite::Exception& failure) {
  constexpr int kConstraint = 19;  // SQLITE_CONSTRAINT
  if (failure.getErrorCode() == kConstraint) return Error{ErrorCode::kInvalidArgument, "scan " + row.id + ": " + failure.what()};
  return database_error(failure);
}

Status SqliteStore::update(const ScanRow& row) try {
  SQLite::Statement change(impl_->database,
                           "UPDATE scans SET phase = ?, words = ?, frames_received = ?, frames_processed = ?, frames_dropped = ?, "
                           "finished_at_ms = ?, to_be_rebuilt = ? WHERE id = ?");
  change.bind(1, std::string(name_of(row.phase)));
  change.bind(2, row.message);
  change.bind(3, row.frames_received);
  change.bind(4, row.frames_processed);
  change.bind(5, row.frames_dropped);
  change.bind(6, row.finished_at_ms);
  change.bind(7, row.to_be_rebuilt ? 1 : 0);
  change.bind(8, row.id);
  if (change.exec() == 0) return Error{ErrorCode::kNotFound, "there is no scan " + row.id};
  return Done{};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Status SqliteStore::rename(const std::string& id, const std::string& title) try {
  SQLite::Statement change(impl_->database, "UPDATE scans SET title = ? WHERE id = ?");
  change.bind(1, title);
  change.bind(2, id);
  if (change.exec() == 0) return Error{ErrorCode::kNotFound, "there is no scan " + id};
  return Done{};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<ScanRow> SqliteStore::find(const std::string& id) try {
  SQLite::Statement query(impl_->database, std::string("SELECT ") + kScanColumns + " FROM scans WHERE id = ?");
  query.bind(1, id);
  if (!query.executeStep()) return Error{ErrorCode::kNotFound, "there is no scan " + id};
  return scan_row_of(query);
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Status SqliteStore::remove(const std::string& id) try {
  SQLite::Statement change(impl_->database, "DELETE FROM scans WHERE id = ?");
  change.bind(1, id);
  if (change.exec() == 0) return Error{ErrorCode::kNotFound, "there is no scan " + id};
  return Done{};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<std::vector<ScanRow>> SqliteStore::list() try {
  SQLite::Statement query(impl_->database, std::string("SELECT ") + kScanColumns + " FROM scans ORDER BY created_at_ms DESC, id LIMIT ?");
  query.bind(1, kMaxListedScans);
  return rows_of(query);
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<std::vector<ScanRow>> SqliteStore::list_older_than(const std::string& id) try {
  const Result<ScanRow> newer = find(id);
  if (!newer.ok()) return newer.error();
  SQLite::Statement query(impl_->database, std::string("SELECT ") + kScanColumns +
                                               " FROM scans WHERE created_at_ms < ?1 OR (created_at_ms = ?1 AND id > ?2) ORDER BY "
                                               "created_at_ms DESC, id LIMIT ?3");
  query.bind(1, newer->created_at_ms);
  query.bind(2, id);
  query.bind(3, kMaxListedScans);
  return rows_of(query);
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<std::vector<ScanRow>> SqliteStore::running() try {
  SQLite::Statement query(impl_->database,
                          std::string("SELECT ") + kScanColumns +
                              " FROM scans WHERE phase = 'running' AND id NOT IN (SELECT scan_id FROM jobs WHERE state IN ('queued', " +
                              "'running')) ORDER BY created_at_ms, id");
  std::vector<ScanRow> rows;
  while (query.executeStep()) rows.push_back(scan_row_of(query));
  return rows;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<std::optional<ScanRow>> SqliteStore::next_to_rebuild() try {
  SQLite::Statement query(impl_->database,
                          std::string("SELECT ") + kScanColumns +
                              " FROM scans WHERE to_be_rebuilt = 1 AND phase <> 'running' ORDER BY created_at_ms, id LIMIT 1");
  return query.executeStep() ? std::optional(scan_row_of(query)) : std::nullopt;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<std::vector<std::string>> SqliteStore::scans_of_token(const std::string& token_id) try {
  SQLite::Statement query(impl_->database, "SELECT id FROM scans WHERE token_id = ?");
  query.bind(1, token_id);
  std::vector<std::string> ids;
  while (query.executeStep()) ids.push_back(query.getColumn(0).getString());
  return ids;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Status SqliteStore::writable() try {
  // Writes a page to the journal and rolls back.
  SQLite::Transaction transaction(impl_->database, SQLite::TransactionBehavior::IMMEDIATE);
  impl_->database.exec("PRAGMA user_version = " + std::to_string(schema_version()));
  return Done{};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Status SqliteStore::check_integrity() const { return check_sqlite_file(path_); }

}  // namespace hermite
