// One connection to PostgreSQL, by libpq. For the sources of server/database only.
//
// Every wait is bounded: connecting and a lock by the constants in the source, a statement by the
// given time. If the server has not ended it by itself a little later, the connection counts as
// lost.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/database/database.h"

struct pg_conn;
struct pg_result;

namespace hermite::server {

// Checks the address of a database, "postgresql://USER@HOST:PORT/DATABASE?…" as libpq reads it.
// kInvalidArgument: it is none; it has a password, which belongs into a file (passfile=FILE); or it
// does not check the certificate of a server on another machine (sslmode=verify-full) without
// `allow_plain`.
Status check_postgres_url(const std::string& url, bool allow_plain);

class PostgresConnection {
 public:
  // Connects, with tables of the schema `hermite`. Zero: a statement may take as long as it takes.
  // Throws DatabaseFailure.
  PostgresConnection(const std::string& url, std::chrono::milliseconds statement_time);

  // As Database::run(). Throws DatabaseFailure.
  SqlResult run(const std::string& sql, const std::vector<SqlValue>& values = {});
  // Runs several statements without parameters, in one transaction of their own unless there is
  // one.
  void run_script(const std::string& sql);

 private:
  struct Closer {
    void operator()(pg_conn* connection) const;
    void operator()(pg_result* result) const;
  };
  using AnyResult = std::unique_ptr<pg_result, Closer>;
  // Waits for the answer to what was sent. Returns the last of several results.
  AnyResult answer();

  std::chrono::milliseconds statement_time_;
  std::unique_ptr<pg_conn, Closer> connection_;
};

}  // namespace hermite::server
