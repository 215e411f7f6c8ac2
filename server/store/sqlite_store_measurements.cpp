// The part of SqliteStore that is about measurements.
#include <sqlite3.h>

#include "server/store/sqlite_connection.h"

namespace hermite {

namespace {

constexpr const char* kMeasurementColumns =
    "id, scan_id, name, from_x, from_y, from_z, to_x, to_y, to_z, distance_m, half_width_m, created_at_ms";

MeasurementRow measurement_row_of(const SQLite::Statement& query) {
  MeasurementRow row;
  row.id = query.getColumn(0).getString();
  row.scan_id = query.getColumn(1).getString();
  row.name = query.getColumn(2).getString();
  for (int axis = 0; axis < 3; ++axis) {
    row.from[static_cast<std::size_t>(axis)] = query.getColumn(3 + axis).getDouble();
    row.to[static_cast<std::size_t>(axis)] = query.getColumn(6 + axis).getDouble();
  }
  row.distance_m = query.getColumn(9).getDouble();
  row.half_width_m = query.getColumn(10).getDouble();
  row.created_at_ms = query.getColumn(11).getInt64();
  return row;
}

}  // namespace

Status SqliteStore::add_measurement(const MeasurementRow& row) try {
  SQLite::Database& database = impl_->database;
  SQLite::Statement scan(database, "SELECT (SELECT count(*) FROM measurements WHERE scan_id = ?1) FROM scans WHERE id = ?1");
  scan.bind(1, row.scan_id);
  if (!scan.executeStep()) return Error{ErrorCode::kNotFound, "there is no scan " + row.scan_id};
  if (scan.getColumn(0).getInt() >= kMaxMeasurementsPerScan)
    return Error{ErrorCode::kBusy, "a scan may have at most " + std::to_string(kMaxMeasurementsPerScan) + " measurements"};
  SQLite::Statement insert(database, std::string("INSERT INTO measurements(") + kMeasurementColumns + ") VALUES(?,?,?,?,?,?,?,?,?,?,?,?)");
  int column = 0;
  for (const std::string& text : {row.id, row.scan_id, row.name}) insert.bind(++column, text);
  for (const std::array<double, 3>& place : {row.from, row.to})
    for (const double value : place) insert.bind(++column, value);
  for (const double value : {row.distance_m, row.half_width_m}) insert.bind(++column, value);
  insert.bind(++column, row.created_at_ms);
  insert.exec();
  return Done{};
} catch (const SQLite::Exception& failure) {
  if (failure.getErrorCode() == SQLITE_CONSTRAINT)
    return Error{ErrorCode::kInvalidArgument, "measurement " + row.id + ": " + failure.what()};
  return database_error(failure);
}

Result<std::vector<MeasurementRow>> SqliteStore::list_measurements(const std::string& scan_id) try {
  SQLite::Statement query(impl_->database,
                          std::string("SELECT ") + kMeasurementColumns + " FROM measurements WHERE scan_id = ? ORDER BY created_at_ms, id");
  query.bind(1, scan_id);
  std::vector<MeasurementRow> rows;
  while (query.executeStep()) rows.push_back(measurement_row_of(query));
  return rows;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Status SqliteStore::remove_measurement(const std::string& scan_id, const std::string& id) try {
  SQLite::Statement change(impl_->database, "DELETE FROM measurements WHERE scan_id = ? AND id = ?");
  change.bind(1, scan_id);
  change.bind(2, id);
  if (change.exec() == 0) return Error{ErrorCode::kNotFound, "scan " + scan_id + " has no measurement " + id};
  return Done{};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

}  // namespace hermite
