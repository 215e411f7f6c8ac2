// A second connection to a database that a server may be using: it reads, and leaves the journal to the server. For the sources of
// server/store only.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string>

#include "core/base/result.h"

namespace hermite {

class SqliteReader {
 public:
  explicit SqliteReader(const std::string& path);  // throws SQLite::Exception
  SQLite::Database& database() { return database_; }

 private:
  SQLite::Database database_;
};

// kCorruptData with the first thing that SQLite finds, or that the file is no database; kIo: it cannot be read now. The whole file is read.
Status check_sqlite_file(const std::string& path);

}  // namespace hermite
