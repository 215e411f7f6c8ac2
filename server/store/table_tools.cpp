#include "server/store/table_tools.h"

#include <fmt/core.h>

namespace hermite::server {

Status changed_or(const SqlResult& result, const Error& otherwise) {
  if (result.changed_count == 0) return otherwise;
  return Done{};
}

bool may_administer(Database& database, const std::string& token_id) {
  if (token_id.empty()) return true;
  const SqlResult result = database.run("SELECT may_admin FROM tokens WHERE id = $1", {token_id});
  return !result.rows.empty() && RowReader(result.rows.front()).flag();
}

Taken taken_of(Database& database, const std::string& count, const std::vector<SqlValue>& values) {
  const SqlResult result = database.run(count, values);
  RowReader next(result.rows.front());
  const std::int64_t in_all = next.integer();
  return {in_all, next.integer()};
}

Status check_room_in_scan(Database& database, const std::string& scan_id, const std::string& table,
                          int limit) {
  const SqlResult result = database.run(
      "SELECT (SELECT count(*) FROM " + table + " WHERE scan_id = $1) FROM scans WHERE id = $1",
      {scan_id});
  if (result.rows.empty()) return Error{ErrorCode::kNotFound, "there is no scan " + scan_id};
  if (RowReader(result.rows.front()).integer() < limit) return Done{};
  return Error{ErrorCode::kBusy, fmt::format("a scan may have at most {} {}", limit, table)};
}

}  // namespace hermite::server
