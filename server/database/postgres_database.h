// The database in PostgreSQL (15 or later), in the schema `hermite`. A change is on the server's
// disk when its transaction is committed.
//
// One Hermite server at a time: it holds an advisory lock for as long as its connection lasts, so
// it needs a direct connection, not one of a pool that hands them out by transactions.
//
// If the connection is lost during a commit, PostgreSQL is asked afterwards whether that
// transaction was committed.
#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "server/database/database.h"
#include "server/database/postgres_connection.h"

namespace hermite::server {

class PostgresDatabase : public Database {
 public:
  // The longest list of the API takes milliseconds; a statement that takes this long is stuck.
  static constexpr std::chrono::milliseconds kStatementTime{10'000};

  // Connects to the address (check_postgres_url), takes the lock and migrates an older schema
  // (postgres_schema.h). A statement that takes longer than `statement_time` fails; zero: none
  // does, for moving all rows. Throws SetupError, with a message: the server does not answer,
  // another Hermite server has the database (kBusy), the schema belongs to another program or is
  // newer than this program knows.
  explicit PostgresDatabase(std::string url,
                            std::chrono::milliseconds statement_time = kStatementTime);
  ~PostgresDatabase() override;
  PostgresDatabase(const PostgresDatabase&) = delete;
  PostgresDatabase& operator=(const PostgresDatabase&) = delete;

  void begin() override;
  void commit() override;
  void rollback() noexcept override;
  // Also takes the lock again. Both go on in the background if they take long: meanwhile, and for a
  // second after they have failed, this fails at once, so that calls do not queue behind a server
  // that does not answer.
  void reconnect() override;
  Status check_writable() override;
  Status check_integrity() const override;

 private:
  SqlResult run_checked(const std::string& sql, const std::vector<SqlValue>& values) override;
  void begin_connecting();
  bool was_committed(const SqlValue& transaction_id);

  const std::string url_;
  const std::chrono::milliseconds statement_time_;
  std::unique_ptr<PostgresConnection> connection_;
  bool in_transaction_ = false;
  std::future<std::unique_ptr<PostgresConnection>> connecting_;
  std::chrono::steady_clock::time_point next_attempt_;
};

}  // namespace hermite::server
