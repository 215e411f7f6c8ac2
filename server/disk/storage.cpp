#include "server/disk/storage.h"

namespace hermite::server {

// The folder goes first: blobs that are files are in it, so nothing remains to wait for.
Status remove_files_of_scan(const Storage& storage, const std::string& scan_id) {
  if (Status status = storage.waste.remove_scan(scan_id); !status.ok()) return status;
  storage.quota.removed(scan_id);
  return storage.blobs.remove(scan_id);
}

}  // namespace hermite::server
