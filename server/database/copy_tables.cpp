#include "server/database/copy_tables.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "core/base/utf8.h"
#include "core/digest/sha256.h"

namespace hermite::server {

namespace {

constexpr int kRowsAtATime = 5000;  // a few megabytes

// The columns of a table in the order of their names, which is not that of every schema.
std::string columns_of(Database& database, const CopiedTable& table) {
  std::vector<std::string> names =
      database.run(std::string("SELECT * FROM ") + table.name + " LIMIT 0").columns;
  std::sort(names.begin(), names.end());
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

void put(std::string& bytes, char kind, std::uint64_t number) {
  bytes += kind;
  for (int shift = 0; shift < 64; shift += 8) bytes += static_cast<char>(number >> shift & 255);
}

void put(std::string& bytes, char kind, const std::string& text) {
  put(bytes, kind, text.size());
  bytes += text;
}

void put(std::string& bytes, const SqlValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return put(bytes, 'i', static_cast<std::uint64_t>(*integer));
  if (const auto* number = std::get_if<double>(&value))
    return put(bytes, 'f', std::bit_cast<std::uint64_t>(*number));
  if (const auto* text = std::get_if<std::string>(&value))
    return put(bytes, 't', readable_utf8(*text));
  if (const auto* content = std::get_if<SqlBytes>(&value)) return put(bytes, 'b', content->bytes);
  bytes += 'n';
}

// Calls `use` for each row of a table, in the order of its key.
template <class Use>
void for_each_row(const Select& select, const CopiedTable& table, const std::string& columns,
                  const Use& use) {
  for (std::int64_t from = 0;; from += kRowsAtATime) {
    const SqlResult piece = select("SELECT " + columns + " FROM " + table.name + " ORDER BY " +
                                       table.key + " LIMIT $1 OFFSET $2",
                                   {std::int64_t{kRowsAtATime}, from});
    for (const SqlRow& row : piece.rows) use(row);
    if (piece.rows.size() < kRowsAtATime) return;
  }
}

// A chain over the rows: each is hashed with the hash of those before it.
void chain(std::string& digest, const SqlRow& row) {
  std::string bytes = digest;
  for (const SqlValue& value : row) put(bytes, value);
  digest = digest::sha256(bytes);
}

}  // namespace

void empty_tables(Database& database) {
  for (auto table = kCopiedTables.rbegin(); table != kCopiedTables.rend(); ++table)
    database.run(std::string("DELETE FROM ") + table->name);
}

Result<CopySummary> copy_tables(const Select& source, Database& target) {
  empty_tables(target);
  const Select from_target = [&target](const std::string& sql,
                                       const std::vector<SqlValue>& values) {
    return target.run(sql, values);
  };
  CopySummary summary;
  for (const CopiedTable& table : kCopiedTables) {
    const std::string columns = columns_of(target, table), insert = insertion(table.name, columns);
    std::string read_digest, written_digest;
    std::int64_t count = 0;
    for_each_row(source, table, columns, [&](const SqlRow& row) {
      chain(read_digest, row);
      target.run(insert, row);
      ++count;
    });
    for_each_row(from_target, table, columns,
                 [&](const SqlRow& row) { chain(written_digest, row); });
    if (read_digest != written_digest)
      return Error{
          ErrorCode::kCorruptData,
          fmt::format("the rows of the table {} differ after they were copied", table.name)};
    if (&table == kCopiedTables.data()) summary.scan_count = count;
    summary.row_count += count;
  }
  return summary;
}

}  // namespace hermite::server
