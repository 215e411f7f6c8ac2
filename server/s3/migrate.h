// Moves the results of a folder of data to S3 and back, while no server uses the folder. Everything
// is copied and read back, and its SHA-256 is compared, before anything is removed. What was
// interrupted is started again: it goes on with what is not there yet.
//
// The database, the frame logs and the checkpoints stay in the folder.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/s3/s3_blobs.h"
#include "server/store/blobs.h"

namespace hermite::server {

struct Migration {
  std::string data_folder;
  Blobs& files;  // the blobs in the folder
  S3Blobs& s3;
  // Scans that have a folder in data_folder.
  std::vector<std::string> scan_ids;
  // Names of blobs that stay in data_folder.
  std::set<std::string> local_names;
  // LocalBlobs::removals_path.
  std::string removals_path;
  // Called with what is being done, as text for people.
  std::function<void(const std::string& message)> says = [](const std::string&) {};
};

struct MigrationCounts {
  std::uint64_t blob_count = 0, bytes = 0;  // that are at the destination now, each compared
  std::uint64_t copied_count = 0;           // of these
};

// kIo: a store fails, or other bytes came back than were copied: nothing was removed. kBusy,
// kInvalidArgument: see begin_move_to_s3, is_in_s3.
Result<MigrationCounts> migrate_to_s3(const Migration& migration);
Result<MigrationCounts> migrate_from_s3(const Migration& migration);

}  // namespace hermite::server
