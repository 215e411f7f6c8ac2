// Folders and files of the data folder that are out of use: a rename moves them to waste/, where
// they are deleted later, or to lost/, from where an administrator may restore them. Either frees
// their id immediately, however large they are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite::server {

// The ids must be valid (is_scan_id), so that they are safe in a path. One owner; const functions
// are thread-safe.
class SetAsideFiles {
 public:
  // Files of that data folder, which has the folders waste/, lost/scans/ and lost/uploads/ before
  // anything is set aside.
  explicit SetAsideFiles(std::string data_folder) : path_(std::move(data_folder)) {}

  // Moves a folder or file to waste/, where remove_waste() deletes it, here or in the next server.
  // Returns its name in waste/; empty if there was nothing. kIo.
  Result<std::string> discard_scan(const std::string& scan_id) const;
  Result<std::string> discard_upload(const std::string& upload_id) const;
  Result<std::string> discard_jobs() const;  // the folder of all jobs
  std::vector<std::string> waste() const;    // names in waste/
  // Takes as long as the disk takes to delete gigabytes.
  Status remove_waste(const std::string& name) const;

  // Moves what has no row in the database to lost/. kIo, also if that id is in lost/ already.
  Status lose_scan(const std::string& scan_id, std::int64_t now_ms) const;
  Status lose_upload(const std::string& upload_id, std::int64_t now_ms) const;
  // Moves what was lost before that time to waste/. Returns the paths in lost/, relative to the
  // data folder.
  std::vector<std::string> discard_lost(std::int64_t lost_before_ms) const;

 private:
  Result<std::string> discard(const std::string& place) const;
  Status lose(const std::string& place, std::int64_t now_ms) const;

  const std::string path_;
};

}  // namespace hermite::server
