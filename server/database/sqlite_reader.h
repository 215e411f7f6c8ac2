// A second connection to a database that a server may be using: it only reads, and leaves the
// journal to the server. For the sources of server/database and for backups only.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string>

#include "core/base/result.h"

namespace hermite::server {

class SqliteReader {
 public:
  explicit SqliteReader(const std::string& path);  // throws SQLite::Exception
  SQLite::Database& database() { return database_; }

 private:
  SQLite::Database database_;
};

// Checks the whole file. kCorruptData with the first problem that SQLite finds, or if the file is
// not a database; kIo: it cannot be read now.
Status check_sqlite_file(const std::string& path);

}  // namespace hermite::server
