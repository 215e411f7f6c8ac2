// Everything that stores or removes data of this server, shared by scans, jobs and uploads. Holds
// only references, so it may be copied.
#pragma once

#include <string>

#include "core/base/result.h"
#include "server/disk/storage_quota.h"
#include "server/disk/waste.h"
#include "server/store/blobs.h"
#include "server/store/data_directory.h"
#include "server/store/store.h"

namespace hermite::server {

struct Storage {
  const DataDirectory& data;
  Store& store;
  Blobs& blobs;
  Waste& waste;
  StorageQuota& quota;
};

// Removes frame log and results, but not the row. Succeeds if there are none. kIo.
Status remove_files_of_scan(const Storage& storage, const std::string& scan_id);

}  // namespace hermite::server
