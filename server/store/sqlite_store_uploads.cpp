// The part of SqliteStore for uploads.
#include <sqlite3.h>

#include "server/store/sqlite_connection.h"

namespace hermite {

namespace {

constexpr const char* kUploadColumns = "id, token_id, length_bytes, metadata, unchecked_from, created_at_ms, expires_at_ms";

UploadRow upload_row_of(const SQLite::Statement& query) {
  UploadRow row;
  row.id = query.getColumn(0).getString();
  row.token_id = query.getColumn(1).getString();
  row.length_bytes = query.getColumn(2).getInt64();
  row.metadata = query.getColumn(3).getString();
  row.unchecked_from = query.getColumn(4).getInt64();
  row.created_at_ms = query.getColumn(5).getInt64();
  row.expires_at_ms = query.getColumn(6).getInt64();
  return row;
}

Error no_upload(const std::string& id) { return {ErrorCode::kNotFound, "there is no upload " + id}; }

}  // namespace

Status SqliteStore::add_upload(const UploadRow& row) try {
  SQLite::Database& database = impl_->database;
  SQLite::Statement count(database, "SELECT count(*), coalesce(sum(token_id = ?1), 0) FROM uploads");
  const Taken taken = taken_of(count, row.token_id);
  if (Status status = check_share(kUploadShare, taken, may_administer(database, row.token_id), "uploads"); !status.ok()) return status;
  SQLite::Statement insert(database, std::string("INSERT INTO uploads(") + kUploadColumns + ") VALUES(?,?,?,?,?,?,?)");
  insert.bind(1, row.id);
  insert.bind(2, row.token_id);
  insert.bind(3, row.length_bytes);
  insert.bind(4, row.metadata);
  insert.bind(5, row.unchecked_from);
  insert.bind(6, row.created_at_ms);
  insert.bind(7, row.expires_at_ms);
  insert.exec();
  return Done{};
} catch (const SQLite::Exception& failure) {
  if (failure.getErrorCode() == SQLITE_CONSTRAINT) return Error{ErrorCode::kInvalidArgument, "upload " + row.id + ": " + failure.what()};
  return database_error(failure);
}

Status SqliteStore::update_upload(const UploadRow& row) try {
  SQLite::Statement change(impl_->database, "UPDATE uploads SET length_bytes = ?, unchecked_from = ?, expires_at_ms = ? WHERE id = ?");
  change.bind(1, row.length_bytes);
  change.bind(2, row.unchecked_from);
  change.bind(3, row.expires_at_ms);
  change.bind(4, row.id);
  if (change.exec() == 0) return no_upload(row.id);
  return Done{};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<UploadRow> SqliteStore::upload(const std::string& id) try {
  SQLite::Statement query(impl_->database, std::string("SELECT ") + kUploadColumns + " FROM uploads WHERE id = ?");
  query.bind(1, id);
  if (!query.executeStep()) return no_upload(id);
  return upload_row_of(query);
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<std::vector<UploadRow>> SqliteStore::list_uploads() try {
  SQLite::Statement query(impl_->database, std::string("SELECT ") + kUploadColumns + " FROM uploads ORDER BY created_at_ms, id");
  std::vector<UploadRow> rows;
  while (query.executeStep()) rows.push_back(upload_row_of(query));
  return rows;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Status SqliteStore::remove_upload(const std::string& id) try {
  SQLite::Statement change(impl_->database, "DELETE FROM uploads WHERE id = ?");
  change.bind(1, id);
  if (change.exec() == 0) return no_upload(id);
  return Done{};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

}  // namespace hermite
