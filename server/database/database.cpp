#include "server/database/database.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace hermite::server {

Error error_of(const DatabaseFailure& failure, const std::string& context) {
  if (failure.kind() == DatabaseFailure::Kind::kConstraint)
    return {ErrorCode::kInvalidArgument, context + ": " + failure.what()};
  const bool is_away = failure.kind() == DatabaseFailure::Kind::kDisconnected;
  return {is_away ? ErrorCode::kUnavailable : ErrorCode::kIo,
          std::string("database: ") + failure.what()};
}

SqlResult Database::run(const std::string& sql, const std::vector<SqlValue>& values) {
  for (const SqlValue& value : values)
    if (const auto* number = std::get_if<double>(&value); number && std::isnan(*number))
      throw DatabaseFailure(DatabaseFailure::Kind::kConstraint, "a number is NaN");
  return run_checked(sql, values);
}

namespace {

DatabaseFailure damaged(const char* wanted) {
  return {DatabaseFailure::Kind::kDamaged, std::string("damaged: a column has no ") + wanted};
}

template <class Type>
const Type& value_of(const SqlValue& value, const char* wanted) {
  const auto* held = std::get_if<Type>(&value);
  if (!held) throw damaged(wanted);
  return *held;
}

}  // namespace

const SqlValue& RowReader::next() {
  if (next_ >= row_.size()) throw damaged("value");
  return row_[next_++];
}

bool RowReader::is_null() const {
  return next_ < row_.size() && std::holds_alternative<std::monostate>(row_[next_]);
}
std::int64_t RowReader::integer() { return value_of<std::int64_t>(next(), "integer"); }
double RowReader::number() { return value_of<double>(next(), "number"); }
std::string RowReader::text() { return value_of<std::string>(next(), "text"); }
std::string RowReader::text_or_null() {
  if (!is_null()) return text();
  skip(1);
  return "";
}
std::string RowReader::bytes() { return value_of<SqlBytes>(next(), "bytes").bytes; }

std::string insertion(const std::string& table, const std::string& columns) {
  const auto count = std::count(columns.begin(), columns.end(), ',') + 1;
  std::string values = "$1";
  for (int i = 2; i <= count; ++i) values += fmt::format(",${}", i);
  return "INSERT INTO " + table + "(" + columns + ") VALUES(" + values + ")";
}

}  // namespace hermite::server
