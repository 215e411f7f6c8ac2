// Copies all rows from one database to another, of the same kind or not.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "core/base/result.h"
#include "server/database/database.h"

namespace hermite::server {

struct CopiedTable {
  const char* name;
  const char* key;  // columns that order its rows
};

// All tables with rows of users, those that are referred to first.
inline constexpr std::array kCopiedTables = {
    CopiedTable{"scans", "id"},
    CopiedTable{"tokens", "id"},
    CopiedTable{"uploads", "id"},
    CopiedTable{"jobs", "id"},
    CopiedTable{"job_lines", "job_id, number"},
    CopiedTable{"measurements", "id"},
    CopiedTable{"measurement_points", "measurement_id, number"},
    CopiedTable{"notes", "id"},
};

struct CopySummary {
  std::int64_t row_count = 0;
  std::int64_t scan_count = 0;
};

// Runs a SELECT of the source, as Database::run(). All of them must see the same rows.
using Select =
    std::function<SqlResult(const std::string& sql, const std::vector<SqlValue>& values)>;

// Within a transaction of `target`: removes all its rows, copies those of `source`, and compares
// both by the SHA-256 of each table. kCorruptData: they differ. Throws DatabaseFailure.
Result<CopySummary> copy_tables(const Select& source, Database& target);

// Within a transaction: removes all rows of users. Throws DatabaseFailure.
void empty_tables(Database& database);

}  // namespace hermite::server
