#include "server/database/sqlite_reader.h"

#include <fmt/core.h>
#include <sqlite3.h>

namespace hermite::server {

SqliteReader::SqliteReader(const std::string& path) : database_(path, SQLite::OPEN_READONLY) {
  database_.setBusyTimeout(5000);
  sqlite3_db_config(database_.getHandle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  database_.exec("PRAGMA query_only = ON");
}

Status check_sqlite_file(const std::string& path) try {
  SqliteReader reader(path);
  const std::string verdict = reader.database().execAndGet("PRAGMA integrity_check(1)").getString();
  if (verdict != "ok")
    return Error{ErrorCode::kCorruptData, fmt::format("{} is damaged: {}", path, verdict)};
  return Done{};
} catch (const SQLite::Exception& failure) {
  const bool corrupt =
      failure.getErrorCode() == SQLITE_CORRUPT || failure.getErrorCode() == SQLITE_NOTADB;
  return Error{corrupt ? ErrorCode::kCorruptData : ErrorCode::kIo, path + ": " + failure.what()};
}

}  // namespace hermite::server
