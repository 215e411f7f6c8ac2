// The rows of measurements. Contract and errors: store.h.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/database/database.h"
#include "server/store/measurement_row.h"

namespace hermite::server {

class MeasurementTable {
 public:
  explicit MeasurementTable(Database& database) : database_(database) {}

  // At most kMaxMeasurementsPerScan. kNotFound: no such scan. kBusy: it has that many already.
  // kInvalidArgument: the id exists already, the kind is invalid, a number is NaN, or the numbers
  // of points and normals differ.
  Status add(const MeasurementRow& row);
  // Oldest first; empty if it has none.
  Result<std::vector<MeasurementRow>> of_scan(const std::string& scan_id);
  // kNotFound: the scan has no such measurement.
  Status remove(const std::string& scan_id, const std::string& id);

 private:
  Database& database_;
};

}  // namespace hermite::server
