// The rows of scans. Contract and errors: store.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/database/database.h"
#include "server/store/scan_row.h"

namespace hermite::server {

inline constexpr int kMaxListedScans = 1000;

class ScanTable {
 public:
  explicit ScanTable(Database& database) : database_(database) {}

  // kInvalidArgument: the id exists already.
  Status add(const ScanRow& row);

  // Writes everything but id, labels, camera, token_id and created_at_ms. kNotFound: no such scan.
  Status update(const ScanRow& row);

  // Writes only title and tags. kNotFound: no such scan.
  Status label(const std::string& id, const ScanLabels& labels);

  // kNotFound: no such scan.
  Result<ScanRow> find(const std::string& id);
  Status remove(const std::string& id);  // with its share links, measurements and notes

  // Return scans newest first, at most kMaxListedScans: the newest ones, or those that follow the
  // given one. kNotFound: no such scan.
  Result<std::vector<ScanRow>> list();
  Result<std::vector<ScanRow>> list_older_than(const std::string& id);

  // Returns all scans that have not ended, oldest first; after a start these are the ones that the
  // previous server left. Leaves out scans of jobs that have not ended, since such a job continues
  // with its scan.
  Result<std::vector<ScanRow>> running();

  // Returns the oldest ended scan that is to be rebuilt; std::nullopt if there is none.
  Result<std::optional<ScanRow>> next_to_rebuild();

  // Returns the ids of all scans of a token, in any state.
  Result<std::vector<std::string>> of_token(const std::string& token_id);

 private:
  Database& database_;
};

}  // namespace hermite::server
