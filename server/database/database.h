// An SQL database, as the tables of server/store see it. There are two: one SQLite file
// (sqlite_database.h), and PostgreSQL (postgres_database.h). Statements are written once, in the
// SQL that both understand; parameters are $1, $2, …
//
// Texts are compared and sorted byte by byte. They should be UTF-8 without NUL characters:
// PostgreSQL has U+FFFD in place of anything else. Truth values are the integers 0 and 1. Numbers
// are not NaN.
//
// One thread at a time, except for check_integrity().
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "core/base/result.h"

namespace hermite::server {

struct SqlBytes {
  std::string bytes;
};
// std::monostate is NULL.
using SqlValue = std::variant<std::monostate, std::int64_t, double, std::string, SqlBytes>;
using SqlRow = std::vector<SqlValue>;

struct SqlResult {
  // Their names; those of other values than columns are not defined.
  std::vector<std::string> columns;
  std::vector<SqlRow> rows;
  // Rows that an INSERT, UPDATE or DELETE changed itself, without those of its foreign keys.
  int changed_count = 0;
};

// Thrown by databases, and turned into an Error by read() and change() below.
class DatabaseFailure : public std::runtime_error {
 public:
  enum class Kind {
    // A key exists already, a row that is referred to does not, or a value is not allowed.
    kConstraint,
    kDisconnected,  // the connection was lost: nothing of the present transaction is kept
    kDamaged,       // the stored data cannot be read
    kOther,
  };
  DatabaseFailure(Kind kind, const std::string& message)
      : std::runtime_error(message), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

class Database {
 public:
  virtual ~Database() = default;

  // Runs one statement. Throws DatabaseFailure; kConstraint also for a NaN.
  SqlResult run(const std::string& sql, const std::vector<SqlValue>& values = {});

  // A transaction that writes: after begin() no other connection changes anything until its end.
  // commit() returns when the changes are durable. Throw DatabaseFailure; if commit() does, nothing
  // was changed, unless it is kOther and the message says that this is not known. rollback() does
  // nothing if there is no transaction.
  virtual void begin() = 0;
  virtual void commit() = 0;
  virtual void rollback() noexcept = 0;

  // Connects again after kDisconnected. Throws DatabaseFailure.
  virtual void reconnect() = 0;

  // Returns whether the database accepts changes at the moment; makes none. kIo, kUnavailable.
  virtual Status check_writable() = 0;

  // Reads the whole database on a connection of its own. kCorruptData: it is damaged, with a
  // message; kIo: it cannot be read now. On any thread.
  virtual Status check_integrity() const = 0;

 private:
  virtual SqlResult run_checked(const std::string& sql, const std::vector<SqlValue>& values) = 0;
};

// Returns kInvalidArgument for a violated constraint, with the message of the database after
// `context`; kUnavailable when the connection was lost; kIo otherwise.
Error error_of(const DatabaseFailure& failure, const std::string& context);

// Calls `body`, which only reads and returns a Result. It is called a second time if the connection
// was lost. Errors of the database are those of error_of.
template <class Body>
auto read(Database& database, const Body& body) -> decltype(body()) {
  for (bool again = true;; again = false) {
    try {
      return body();
    } catch (const DatabaseFailure& failure) {
      if (failure.kind() != DatabaseFailure::Kind::kDisconnected || !again)
        return error_of(failure, "database");
    }
    try {
      database.reconnect();
    } catch (const DatabaseFailure& failure) {
      return error_of(failure, "database");
    }
  }
}

// Calls `body`, which returns a Status or a Result, in a transaction: it is committed if the result
// is ok, and rolled back otherwise. `body` is called a second time if the connection was lost and
// nothing was changed. A violated constraint is kInvalidArgument with `context` before its message;
// other errors of the database are those of error_of.
template <class Body>
auto change(Database& database, const std::string& context, const Body& body) -> decltype(body()) {
  for (bool again = true;; again = false) {
    try {
      database.begin();
      auto result = body();
      if (!result.ok()) {
        database.rollback();
        return result;
      }
      database.commit();
      return result;
    } catch (const DatabaseFailure& failure) {
      database.rollback();
      if (failure.kind() != DatabaseFailure::Kind::kDisconnected || !again)
        return error_of(failure, context);
    }
    try {
      database.reconnect();
    } catch (const DatabaseFailure& failure) {
      return error_of(failure, context);
    }
  }
}

// Reads the values of a row in the order of its columns. Throws DatabaseFailure if there is none
// left, or it has another type than the one asked for: the database is damaged.
class RowReader {
 public:
  explicit RowReader(const SqlRow& row) : row_(row) {}

  bool is_null() const;  // the next value, which is not read
  void skip(std::size_t count) { next_ += count; }
  std::int64_t integer();
  int small_integer() { return static_cast<int>(integer()); }
  bool flag() { return integer() != 0; }
  double number();
  std::string text();
  std::string text_or_null();  // empty for NULL
  std::string bytes();

 private:
  const SqlValue& next();

  const SqlRow& row_;
  std::size_t next_ = 0;
};

// For LIMIT, where there is only an OFFSET.
inline constexpr const char* kNoLimit = "9223372036854775807";

// Returns "INSERT INTO TABLE(COLUMNS) VALUES($1,…)" with as many values as `columns`, separated by
// commas, has names.
std::string insertion(const std::string& table, const std::string& columns);

}  // namespace hermite::server
