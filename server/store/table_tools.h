// What several tables do. For the sources of server/store only, in a transaction. Functions throw
// DatabaseFailure.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/database/database.h"
#include "server/store/shares.h"

namespace hermite::server {

// Returns the rows of a statement, each made by `row_of`.
template <class RowOf>
auto rows_of(const SqlResult& result, const RowOf& row_of)
    -> Result<std::vector<decltype(row_of(SqlRow()))>> {
  std::vector<decltype(row_of(SqlRow()))> rows;
  for (const SqlRow& row : result.rows) rows.push_back(row_of(row));
  return rows;
}

// Returns `otherwise` if the statement has changed no row.
Status changed_or(const SqlResult& result, const Error& otherwise);

// Returns whether a token has the scope admin. An empty id, which is the owner of the data folder,
// does; an unknown token does not.
bool may_administer(Database& database, const std::string& token_id);

// Runs `count`, a SELECT of a total and how many of it belong to the token that asks, with these
// parameters.
Taken taken_of(Database& database, const std::string& count, const std::vector<SqlValue>& values);

// Checks that the scan exists and has fewer than `limit` rows in `table`. kNotFound; kBusy.
Status check_room_in_scan(Database& database, const std::string& scan_id, const std::string& table,
                          int limit);

}  // namespace hermite::server
