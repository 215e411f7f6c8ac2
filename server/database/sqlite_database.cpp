#include "server/database/sqlite_database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/core.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <filesystem>
#include <optional>
#include <system_error>

#include "server/database/sqlite_reader.h"
#include "server/database/sqlite_schema.h"

namespace hermite::server {

namespace {

// A server that ends normally leaves no WAL. If there is one, the previous server crashed, perhaps
// with its machine.
bool ended_uncleanly(const std::string& path) {
  std::error_code error;
  const std::uintmax_t log_bytes = std::filesystem::file_size(path + "-wal", error);
  return !error && log_bytes > 0;
}

// SQLite gives its other files the mode of the first one. The mode of files of another owner cannot
// be changed here, but the folder is closed to others (data_directory.h).
void make_files_private(const std::string& path) {
  for (const char* ending : {"", "-wal", "-shm"})
    if (struct stat status{};
        stat((path + ending).c_str(), &status) == 0 && (status.st_mode & 0077) != 0)
      chmod((path + ending).c_str(), 0600);
}

SetupError damaged(const std::string& path, const std::string& found) {
  return SetupError(
      {ErrorCode::kCorruptData, fmt::format("the database {} is damaged ({}): restore a backup, or "
                                            "move it away; the scans' files are not in it",
                                            path, found)});
}

void check_whole(SQLite::Database& database, const std::string& path) {
  const std::string found = database.execAndGet("PRAGMA quick_check(1)").getString();
  if (found != "ok") throw damaged(path, found);
}

DatabaseFailure failure_of(const SQLite::Exception& failure) {
  using Kind = DatabaseFailure::Kind;
  const int code = failure.getErrorCode();
  return {code == SQLITE_CONSTRAINT ? Kind::kConstraint
          : code == SQLITE_CORRUPT  ? Kind::kDamaged
                                    : Kind::kOther,
          failure.what()};
}

void bind_value(SQLite::Statement& statement, const std::string& name, const SqlValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return statement.bind(name, *integer);
  if (const auto* number = std::get_if<double>(&value)) return statement.bind(name, *number);
  if (const auto* text = std::get_if<std::string>(&value)) return statement.bind(name, *text);
  if (const auto* bytes = std::get_if<SqlBytes>(&value))
    return statement.bind(name, bytes->bytes.data(), static_cast<int>(bytes->bytes.size()));
  statement.bind(name);  // NULL
}

SqlValue value_of(const SQLite::Column& column) {
  if (column.isInteger()) return column.getInt64();
  if (column.isFloat()) return column.getDouble();
  if (column.isText()) return column.getString();
  if (column.isBlob()) return SqlBytes{column.getString()};
  return std::monostate();
}

}  // namespace

struct SqliteDatabase::Connection {
  SQLite::Database database;
  std::optional<SQLite::Transaction> transaction;

  // Opens or creates the file without changing anything yet. Throws SQLite::Exception.
  explicit Connection(const std::string& path)
      : database(path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE) {
    database.setBusyTimeout(5000);
    set({"trusted_schema = OFF", "cell_size_check = ON", "foreign_keys = ON"});
  }
  void set(std::initializer_list<const char*> settings) {
    for (const char* setting : settings) database.exec(std::string("PRAGMA ") + setting);
  }
};

SqliteDatabase::SqliteDatabase(const std::string& path) : path_(path) {
  try {
    const bool unclean = ended_uncleanly(path);
    connection_ = std::make_unique<Connection>(path);
    make_files_private(path);
    if (unclean) check_whole(connection_->database, path);
    migrate(connection_->database, path);
    // Only now, so that a database that was refused above stays unchanged.
    connection_->set({"journal_mode = WAL", "synchronous = FULL", "journal_size_limit = 67108864"});
  } catch (const SQLite::Exception& failure) {
    if (failure.getErrorCode() == SQLITE_CORRUPT) throw damaged(path, failure.what());
    throw SetupError(
        {ErrorCode::kIo, fmt::format("opening the database {}: {}", path, failure.what())});
  }
}

SqliteDatabase::~SqliteDatabase() = default;

SqlResult SqliteDatabase::run_checked(const std::string& sql,
                                      const std::vector<SqlValue>& values) try {
  SQLite::Statement statement(connection_->database, sql);
  for (std::size_t i = 0; i < values.size(); ++i)
    bind_value(statement, fmt::format("${}", i + 1), values[i]);
  SqlResult result;
  for (int i = 0; i < statement.getColumnCount(); ++i)
    result.columns.emplace_back(statement.getColumnName(i));
  while (statement.executeStep()) {
    SqlRow row;
    for (int i = 0; i < statement.getColumnCount(); ++i)
      row.push_back(value_of(statement.getColumn(i)));
    result.rows.push_back(std::move(row));
  }
  result.changed_count = statement.getChanges();
  return result;
} catch (const SQLite::Exception& failure) {
  throw failure_of(failure);
}

void SqliteDatabase::begin() try {
  connection_->transaction.emplace(connection_->database, SQLite::TransactionBehavior::IMMEDIATE);
} catch (const SQLite::Exception& failure) {
  throw failure_of(failure);
}

void SqliteDatabase::commit() try {
  connection_->transaction->commit();
  connection_->transaction.reset();
} catch (const SQLite::Exception& failure) {
  throw failure_of(failure);
}

void SqliteDatabase::rollback() noexcept { connection_->transaction.reset(); }

Status SqliteDatabase::check_writable() try {
  // Writes a page to the journal and rolls back.
  SQLite::Transaction transaction(connection_->database, SQLite::TransactionBehavior::IMMEDIATE);
  connection_->database.exec(fmt::format("PRAGMA user_version = {}", schema_version()));
  return Done{};
} catch (const SQLite::Exception& failure) {
  return error_of(failure_of(failure), "database");
}

Status SqliteDatabase::check_integrity() const { return check_sqlite_file(path_); }

}  // namespace hermite::server
