// The database in one SQLite file. A change is on disk (synchronous = FULL) when its transaction is
// committed.
//
// There is one connection, and no other runs WAL checkpoints: SQLite 3.40 can lose a WAL that two
// connections reset.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/database/database.h"

namespace hermite::server {

class SqliteDatabase : public Database {
 public:
  // Opens or creates the file, and migrates an older schema after a backup (sqlite_schema.h).
  // Throws SetupError, with a message: not a database, damaged, of another program, or with a newer
  // schema than this program knows (left unchanged).
  explicit SqliteDatabase(const std::string& path);
  ~SqliteDatabase() override;
  SqliteDatabase(const SqliteDatabase&) = delete;
  SqliteDatabase& operator=(const SqliteDatabase&) = delete;

  void begin() override;
  void commit() override;
  void rollback() noexcept override;
  void reconnect() override {}  // a file is never disconnected
  Status check_writable() override;
  Status check_integrity() const override;

 private:
  SqlResult run_checked(const std::string& sql, const std::vector<SqlValue>& values) override;

  struct Connection;
  const std::string path_;
  std::unique_ptr<Connection> connection_;
};

}  // namespace hermite::server
