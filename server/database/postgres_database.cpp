#include "server/database/postgres_database.h"

#include <future>
#include <thread>
#include <utility>

#include "server/database/copy_tables.h"
#include "server/database/postgres_schema.h"

namespace hermite::server {

namespace {

using Kind = DatabaseFailure::Kind;
using std::chrono::milliseconds;

// PostgreSQL notices within milliseconds that the connection of a killed process is gone; and a
// commit takes no longer than a few of its disk's syncs.
constexpr milliseconds kLockPatience(5000), kCommitPatience(5000), kPoll(50);
constexpr std::chrono::seconds kPause(1);

// Enough for a server that was only restarted; cameras wait for the thread that calls.
constexpr milliseconds kReconnectPatience(300);

constexpr std::int64_t kLock = 0x48524246;  // "HRBF", among the advisory locks of the database

// Calls `is_done` until it returns true or the time is over. Returns the last value.
template <class Done>
bool wait_until(const Done& is_done, milliseconds patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!is_done()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(kPoll);
  }
  return true;
}

std::unique_ptr<PostgresConnection> connected(const std::string& url, milliseconds statement_time) {
  auto connection = std::make_unique<PostgresConnection>(url, statement_time);
  const auto has_lock = [&connection] {
    return !connection->run("SELECT 1 WHERE pg_try_advisory_lock($1)", {kLock}).rows.empty();
  };
  if (!wait_until(has_lock, kLockPatience))
    throw SetupError(
        {ErrorCode::kBusy, "another Hermite server is using the database in PostgreSQL"});
  return connection;
}

}  // namespace

PostgresDatabase::PostgresDatabase(std::string url, milliseconds statement_time)
    : url_(std::move(url)), statement_time_(statement_time) {
  try {
    connection_ = connected(url_, statement_time_);
    migrate(*connection_);
  } catch (const DatabaseFailure& failure) {
    throw SetupError(
        {ErrorCode::kIo, std::string("opening the database in PostgreSQL: ") + failure.what()});
  }
}

PostgresDatabase::~PostgresDatabase() = default;

void PostgresDatabase::begin_connecting() {
  connection_.reset();  // which gives the lock back
  in_transaction_ = false;
  if (!connecting_.valid())
    connecting_ = std::async(std::launch::async, connected, url_, statement_time_);
}

void PostgresDatabase::reconnect() {
  if (std::chrono::steady_clock::now() < next_attempt_)
    throw DatabaseFailure(Kind::kDisconnected, "there is no connection to PostgreSQL");
  begin_connecting();
  if (connecting_.wait_for(kReconnectPatience) != std::future_status::ready)
    throw DatabaseFailure(Kind::kDisconnected, "PostgreSQL is being connected to again");
  try {
    connection_ = connecting_.get();
  } catch (const SetupError& error) {
    next_attempt_ = std::chrono::steady_clock::now() + kPause;
    throw DatabaseFailure(Kind::kOther, error.what());
  } catch (const DatabaseFailure&) {
    next_attempt_ = std::chrono::steady_clock::now() + kPause;
    throw;
  }
}

SqlResult PostgresDatabase::run_checked(const std::string& sql,
                                        const std::vector<SqlValue>& values) {
  if (!connection_)
    throw DatabaseFailure(Kind::kDisconnected, "there is no connection to PostgreSQL");
  return connection_->run(sql, values);
}

void PostgresDatabase::begin() {
  run("BEGIN");
  in_transaction_ = true;
}

void PostgresDatabase::commit() {
  const SqlResult assigned = run("SELECT pg_current_xact_id_if_assigned()::text");
  const SqlValue id = assigned.rows.front().front();
  try {
    run("COMMIT");
    in_transaction_ = false;
    return;
  } catch (const DatabaseFailure& failure) {
    if (failure.kind() != Kind::kDisconnected) throw;
  }
  if (was_committed(id)) return;
  throw DatabaseFailure(Kind::kDisconnected, "the connection was lost, and nothing was changed");
}

bool PostgresDatabase::was_committed(const SqlValue& transaction_id) {
  begin_connecting();
  // It has changed nothing.
  if (std::holds_alternative<std::monostate>(transaction_id)) return true;
  std::string state;
  const auto is_over = [&] {
    try {
      if (!connection_) begin_connecting();
      if (connecting_.valid()) connection_ = connecting_.get();  // which takes a bounded time
      state = RowReader(run("SELECT pg_xact_status($1::text::xid8)", {transaction_id}).rows.front())
                  .text_or_null();
      return state != "in progress";
    } catch (const std::exception&) {
      connection_.reset();  // it may still be starting again
      return false;
    }
  };
  wait_until(is_over, kCommitPatience);
  if (state != "committed" && state != "aborted")
    throw DatabaseFailure(
        Kind::kOther,
        "the connection was lost during a change, and whether it was made is not known");
  return state == "committed";
}

void PostgresDatabase::rollback() noexcept {
  if (!std::exchange(in_transaction_, false)) return;
  try {
    run("ROLLBACK");
  } catch (const std::exception&) {
    connection_.reset();  // which rolls back
  }
}

Status PostgresDatabase::check_writable() {
  return read(*this, [&]() -> Status {
    try {
      begin();
      run("UPDATE about SET version = version");
    } catch (const DatabaseFailure&) {
      rollback();
      throw;
    }
    rollback();
    return Done{};
  });
}

Status PostgresDatabase::check_integrity() const try {
  PostgresConnection connection(url_, {});
  // Each row as a text, so that each value of it is read.
  for (const CopiedTable& table : kCopiedTables)
    connection.run(std::string("SELECT sum(length(t::text)) FROM ") + table.name + " t");
  return Done{};
} catch (const DatabaseFailure& failure) {
  return Error{failure.kind() == Kind::kDamaged ? ErrorCode::kCorruptData : ErrorCode::kIo,
               std::string("the database in PostgreSQL: ") + failure.what()};
}

}  // namespace hermite::server
