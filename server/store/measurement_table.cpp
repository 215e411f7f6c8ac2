#include "server/store/measurement_table.h"

#include <fmt/core.h>

#include <optional>

#include "server/store/table_tools.h"

namespace hermite::server {

namespace {

constexpr const char* kMeasurementColumns =
    "id, scan_id, name, kind, up_x, up_y, up_z, value, half_width, created_at_ms";
constexpr const char* kPointColumns =
    "measurement_id, number, x, y, z, normal_x, normal_y, normal_z";

using Triple = MeasurementRow::Triple;

// Appends three NULLs for none.
void append(std::vector<SqlValue>& values, const std::optional<Triple>& triple) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    values.push_back(triple ? SqlValue((*triple)[axis]) : SqlValue());
}

std::optional<Triple> triple_of(RowReader& next) {
  if (next.is_null()) {
    next.skip(3);
    return std::nullopt;
  }
  const double x = next.number(), y = next.number();
  return Triple{x, y, next.number()};
}

std::vector<SqlValue> values_of(const MeasurementRow& row) {
  std::vector<SqlValue> values = {row.id, row.scan_id, row.name, row.kind};
  append(values, row.up);
  for (const SqlValue& value :
       {SqlValue(row.value), SqlValue(row.half_width), SqlValue(row.created_at_ms)})
    values.push_back(value);
  return values;
}

// Does not read its points.
MeasurementRow measurement_row_of(const SqlRow& values) {
  RowReader next(values);
  MeasurementRow row;
  row.id = next.text();
  row.scan_id = next.text();
  row.name = next.text();
  row.kind = next.text();
  row.up = triple_of(next);
  row.value = next.number();
  row.half_width = next.number();
  row.created_at_ms = next.integer();
  return row;
}

void insert_points(Database& database, const MeasurementRow& row) {
  for (std::size_t i = 0; i < row.points.size(); ++i) {
    std::vector<SqlValue> values = {row.id, static_cast<std::int64_t>(i)};
    append(values, row.points[i]);
    append(values, row.normals.empty() ? std::nullopt : std::optional(row.normals[i]));
    database.run(insertion("measurement_points", kPointColumns), values);
  }
}

void read_points(Database& database, MeasurementRow& row) {
  const SqlResult result = database.run(
      "SELECT x, y, z, normal_x, normal_y, normal_z FROM measurement_points WHERE measurement_id = "
      "$1 ORDER BY number",
      {row.id});
  for (const SqlRow& values : result.rows) {
    RowReader next(values);
    if (const auto point = triple_of(next)) row.points.push_back(*point);
    if (const auto normal = triple_of(next)) row.normals.push_back(*normal);
  }
}

}  // namespace

Status MeasurementTable::add(const MeasurementRow& row) {
  if (!row.normals.empty() && row.normals.size() != row.points.size())
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("measurement {}: it has not as many normals as points", row.id)};
  return change(database_, "measurement " + row.id, [&]() -> Status {
    Status status =
        check_room_in_scan(database_, row.scan_id, "measurements", kMaxMeasurementsPerScan);
    if (!status.ok()) return status;
    database_.run(insertion("measurements", kMeasurementColumns), values_of(row));
    insert_points(database_, row);
    return status;
  });
}

Result<std::vector<MeasurementRow>> MeasurementTable::of_scan(const std::string& scan_id) {
  return read(database_, [&]() -> Result<std::vector<MeasurementRow>> {
    std::vector<MeasurementRow> rows;
    const SqlResult result =
        database_.run(std::string("SELECT ") + kMeasurementColumns +
                          " FROM measurements WHERE scan_id = $1 ORDER BY created_at_ms, id",
                      {scan_id});
    for (const SqlRow& row : result.rows) rows.push_back(measurement_row_of(row));
    for (MeasurementRow& row : rows) read_points(database_, row);
    return rows;
  });
}

Status MeasurementTable::remove(const std::string& scan_id, const std::string& id) {
  return change(database_, "measurement " + id, [&]() -> Status {
    if (database_.run("DELETE FROM measurements WHERE scan_id = $1 AND id = $2", {scan_id, id})
            .changed_count > 0)
      return Done{};
    return Error{ErrorCode::kNotFound, fmt::format("scan {} has no measurement {}", scan_id, id)};
  });
}

}  // namespace hermite::server
