// The folder that is one server's memory:
//
//   lock          held (flock) for as long as the server runs, so that two servers never share a folder
//   token         64 hex digits, mode 0600
//   hermite.db    one row a scan (store.h)
//   scans/ID/     cloud.ply trajectory.txt report.json chunks.bin of a scan that has ended
//   scans/ID/log/ its frames as they came (frame_log.h)
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite {

// Owns the lock. One owner; const functions are thread-safe.
class DataDirectory {
 public:
  // Creates the folder (mode 0700), takes the lock and reads or makes the token. Throws SetupError in words: not writable, in use by
  // another server, a token file that holds no token.
  explicit DataDirectory(const std::string& path);
  ~DataDirectory();
  DataDirectory(const DataDirectory&) = delete;
  DataDirectory& operator=(const DataDirectory&) = delete;

  const std::string& token() const { return token_; }
  std::string database_path() const { return path_ + "/hermite.db"; }

  // `scan_id` must be one (is_scan_id); a path is made of nothing else.
  std::string scan_folder(const std::string& scan_id) const;
  std::string log_folder(const std::string& scan_id) const { return scan_folder(scan_id) + "/log"; }
  Status create_scan_folder(const std::string& scan_id) const;
  Status remove_scan_folder(const std::string& scan_id) const;
  Status remove_log_folder(const std::string& scan_id) const;  // well, too, when there is none

 private:
  std::string path_;
  std::string token_;
  int lock_file_ = -1;
};

// Bytes free for us in the file system that holds `path` (which must exist).
Result<std::uint64_t> free_bytes(const std::string& path);

}  // namespace hermite
