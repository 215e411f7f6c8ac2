// The part of SqliteStore for measurements.
#include <sqlite3.h>

#include "server/store/sqlite_connection.h"

namespace hermite {

namespace {

constexpr const char* kMeasurementColumns = "id, scan_id, name, kind, up_x, up_y, up_z, value, half_width, created_at_ms";

// Returns std::nullopt if the first column is NULL.
std::optional<MeasurementRow::Triple> triple_at(const SQLite::Statement& query, int column) {
  if (query.getColumn(column).isNull()) return std::nullopt;
  return MeasurementRow::Triple{query.getColumn(column).getDouble(), query.getColumn(column + 1).getDouble(),
                                query.getColumn(column + 2).getDouble()};
}

void bind_triple(SQLite::Statement& statement, int& column, const std::optional<MeasurementRow::Triple>& triple) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (triple)
      statement.bind(++column, (*triple)[axis]);
    else
      statement.bind(++column);
}

// Does not read its points.
MeasurementRow measurement_row_of(const SQLite::Statement& query) {
  MeasurementRow row;
  row.id = query.getColumn(0).getString();
  row.scan_id = query.getColumn(1).getString();
  row.name = query.getColumn(2).getString();
  row.kind = query.getColumn(3).getString();
  row.up = triple_at(query, 4);
  row.value = query.getColumn(7).getDouble();
  row.half_width = query.getColumn(8).getDouble();
  row.created_at_ms = query.getColumn(9).getInt64();
  return row;
}

void insert_measurement(SQLite::Database& database, const MeasurementRow& row) {
  SQLite::Statement insert(database, std::string("INSERT INTO measurements(") + kMeasurementColumns + ") VALUES(?,?,?,?,?,?,?,?,?,?)");
  int column = 0;
  for (const std::string& text : {row.id, row.scan_id, row.name, row.kind}) insert.bind(++column, text);
  bind_triple(insert, column, row.up);
  for (const double value : {row.value, row.half_width}) insert.bind(++column, value);
  insert.bind(++column, row.created_at_ms);
  insert.exec();
}

void insert_points(SQLite::Database& database, const MeasurementRow& row) {
  SQLite::Statement insert(database,
                           "INSERT INTO measurement_points(measurement_id, number, x, y, z, normal_x, normal_y, normal_z) "
                           "VALUES(?,?,?,?,?,?,?,?)");
  for (std::size_t i = 0; i < row.points.size(); ++i) {
    insert.reset();
    insert.bind(1, row.id);
    insert.bind(2, static_cast<std::int64_t>(i));
    int column = 2;
    bind_triple(insert, column, row.points[i]);
    bind_triple(insert, column, row.normals.empty() ? std::nullopt : std::optional(row.normals[i]));
    insert.exec();
  }
}

void read_points(SQLite::Database& database, MeasurementRow& row) {
  SQLite::Statement query(database,
                          "SELECT x, y, z, normal_x, normal_y, normal_z FROM measurement_points WHERE measurement_id = ? ORDER BY number");
  query.bind(1, row.id);
  while (query.executeStep()) {
    if (const auto point = triple_at(query, 0)) row.points.push_back(*point);
    if (const auto normal = triple_at(query, 3)) row.normals.push_back(*normal);
  }
}

}  // namespace

Status SqliteStore::add_measurement(const MeasurementRow& row) try {
  if (!row.normals.empty() && row.normals.size() != row.points.size())
    return Error{ErrorCode::kInvalidArgument, "measurement " + row.id + ": it has not as many normals as points"};
  SQLite::Database& database = impl_->database;
  SQLite::Statement scan(database, "SELECT (SELECT count(*) FROM measurements WHERE scan_id = ?1) FROM scans WHERE id = ?1");
  scan.bind(1, row.scan_id);
  if (!scan.executeStep()) return Error{ErrorCode::kNotFound, "there is no scan " + row.scan_id};
  if (scan.getColumn(0).getInt() >= kMaxMeasurementsPerScan)
    return Error{ErrorCode::kBusy, "a scan may have at most " + std::to_string(kMaxMeasurementsPerScan) + " measurements"};
  scan.reset();
  SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
  insert_measurement(database, row);
  insert_points(database, row);
  transaction.commit();
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
  for (MeasurementRow& row : rows) read_points(impl_->database, row);
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
