// The rows of uploads. Contract and errors: store.h.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/database/database.h"
#include "server/store/upload_row.h"

namespace hermite::server {

class UploadTable {
 public:
  explicit UploadTable(Database& database) : database_(database) {}

  // kBusy: the share of its token is used up. kInvalidArgument: the id exists already.
  Status add(const UploadRow& row);
  // kNotFound: no such upload.
  Status update(const UploadRow& row);  // length, unchecked_from and expires_at_ms
  Result<UploadRow> find(const std::string& id);
  Status remove(const std::string& id);

  Result<std::vector<UploadRow>> list();  // oldest first

 private:
  Database& database_;
};

}  // namespace hermite::server
