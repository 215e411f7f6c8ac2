// The folder that is one server's memory:
//
//   lock          held (flock) for as long as the server runs, so that two programs never share a folder; the server's address is in it
//   token         the first token: 64 hex digits, mode 0600
//   hermite.db    scans, tokens, uploads and jobs (sqlite_store.h)
//   scans/ID/     cloud.ply trajectory.txt report.json chunks.bin of a scan that has ended (blobs.h)
//   scans/ID/log/ its frames as they came (frame_log.h)
//   scans/ID/checkpoint.bin  of one that runs: what it has come to (checkpoint_file.h)
//   uploads/ID    the bytes of an upload, as far as they have come
//   jobs/ID/      what a running job has unpacked; empty at every start
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite {

// Owns the lock. One owner; const functions are thread-safe.
class DataDirectory {
 public:
  // Creates the folder (mode 0700), takes the lock and reads or makes the token. Throws SetupError in words: not writable, in use by
  // another server (kBusy), a token file that holds no token.
  explicit DataDirectory(const std::string& path);
  ~DataDirectory();
  DataDirectory(const DataDirectory&) = delete;
  DataDirectory& operator=(const DataDirectory&) = delete;

  const std::string& token() const { return token_; }
  std::string database_path() const { return path_ + "/hermite.db"; }

  // Writes where this server listens into the lock file, for programs beside it.
  Status publish_address(const std::string& url) const;

  // Bytes of all files of all scans and uploads, those of `except_upload_id` left out. What running jobs have unpacked goes with them and
  // does not count. kIo.
  Result<std::uint64_t> stored_bytes(const std::string& except_upload_id = "") const;

  // `scan_id` must be one (is_scan_id); a path is made of nothing else.
  std::string scans_folder() const { return path_ + "/scans"; }
  std::string scan_folder(const std::string& scan_id) const;
  std::string log_folder(const std::string& scan_id) const { return scan_folder(scan_id) + "/log"; }
  Status create_scan_folder(const std::string& scan_id) const;
  Status remove_scan_folder(const std::string& scan_id) const;
  Status remove_log_folder(const std::string& scan_id) const;  // well, too, when there is none

  // As above: the id must be one.
  std::string upload_path(const std::string& upload_id) const;
  std::string uploads_folder() const { return path_ + "/uploads"; }
  std::string job_folder(const std::string& job_id) const;
  Status create_job_folder(const std::string& job_id) const;
  Status remove_job_folder(const std::string& job_id) const;  // well, too, when there is none

  // Bytes free for us in the file system of this folder. kIo.
  Result<std::uint64_t> free_disk_bytes() const;

 private:
  std::string path_;
  std::string token_;
  int lock_file_ = -1;
};

// How a program beside a server talks to it.
struct PublishedServer {
  std::string url;    // as published
  std::string token;  // the first token
};

// Of the server that holds the lock of `path`. kNotFound: none has published its address there, or there is no token. kIo.
Result<PublishedServer> published_server(const std::string& path);

// Bytes free for us in the file system that holds `path` (which must exist).
Result<std::uint64_t> free_bytes(const std::string& path);

}  // namespace hermite
