// The folder that holds all data of a server:
//
//   lock          locked (flock) while the server runs; holds the server's address (folder_lock.h)
//   token         the first token (first_token.h)
//   hermite.db    all rows (store.h)
//   rows-at       says that these are in PostgreSQL and not here (rows_place.h)
//   scans/ID/     of an ended scan (blobs.h): cloud.ply surfels.ply trajectory.txt tracking.txt
//                 thumbnail.jpg report.json chunks.bin, its edits, its exports
//   scans/ID/log/ the frames of the scan as received (frame_log.h)
//   scans/ID/checkpoint.bin
//                 the state of a running scan (checkpoint_file.h)
//   uploads/ID    the bytes of an upload received so far
//   jobs/ID/      the files that a running job has unpacked; emptied at every start
//   waste/        removed files whose deletion has not finished (set_aside_files.h)
//   restore.unfinished
//                 marks an interrupted restore: no server starts here
//   blobs-at      says that the results of scans are in S3 and not here, and where
//                 (server/s3/remote_setup.h)
//   blob-removals results that are to be removed from S3 (server/s3/remote_blobs.h)
//   probe         exists briefly, to test whether the disk is writable (disk_space.h)
//   lost/         scans/ID and uploads/ID that had no row in the database at a start (orphans.h)
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/store/folder_lock.h"
#include "server/store/set_aside_files.h"

namespace hermite::server {

// Name of the mark in a folder into which a backup is being restored (backup.h).
inline constexpr const char* kRestoreMark = "restore.unfinished";

// The folder of the audit log, and its head there (server/access/audit.h). A backup copies the head
// before the rest of the folder, so that the backup of a running server does not claim entries that
// it lacks.
inline constexpr const char *kAuditFolder = "audit", *kAuditHeadName = "head";

// The folder of this server, which it holds the lock of, and the places of scans, uploads and jobs
// in it. One owner; const functions are thread-safe.
class DataDirectory {
 public:
  // Creates the folder with mode 0700, or closes an existing one to other users, takes the lock and
  // reads or creates the token. Throws SetupError, with a message: not writable, in use by another
  // server (kBusy), open to other users and owned by somebody else, a token file without a token,
  // an interrupted restore. From here on, folders and token survive a power failure.
  explicit DataDirectory(const std::string& path);
  DataDirectory(const DataDirectory&) = delete;
  DataDirectory& operator=(const DataDirectory&) = delete;

  const FolderLock& lock() const { return lock_; }
  const SetAsideFiles& set_aside() const { return set_aside_; }  // what is in waste/ and lost/
  const std::string& path() const { return path_; }
  const std::string& token() const { return token_; }
  std::string database_path() const { return path_ + "/hermite.db"; }
  std::string audit_folder() const { return path_ + "/" + kAuditFolder; }
  std::string retention_path() const { return path_ + "/retention"; }

  // Returns the size of all files of each scan, by its id, in bytes. Looks at every file, so do not
  // call it on a thread that others wait for. kIo.
  Result<std::map<std::string, std::uint64_t>> scan_sizes() const;

  // Returns the size of all uploads except the given one, in bytes. Fast, since there are few
  // (kUploadShare). kIo.
  Result<std::uint64_t> uploads_bytes(const std::string& except_upload_id = "") const;

  // `scan_id` must be valid (is_scan_id), so that it is safe in a path.
  std::string scans_folder() const { return path_ + "/scans"; }
  std::string scan_folder(const std::string& scan_id) const;
  std::string log_folder(const std::string& scan_id) const { return scan_folder(scan_id) + "/log"; }
  Status create_scan_folder(const std::string& scan_id) const;
  Status remove_scan_folder(const std::string& scan_id) const;
  Status remove_log_folder(const std::string& scan_id) const;  // succeeds if there is none

  // `upload_id` and `job_id` must be valid, as above.
  std::string upload_path(const std::string& upload_id) const;
  std::string uploads_folder() const { return path_ + "/uploads"; }
  std::string job_folder(const std::string& job_id) const;
  Status create_job_folder(const std::string& job_id) const;
  Status remove_job_folder(const std::string& job_id) const;  // succeeds if there is none

  // Returns the ids that have a folder or a file, whether the database has a row for them or not.
  // kIo.
  Result<std::vector<std::string>> scan_ids() const;
  Result<std::vector<std::string>> logged_scan_ids() const;  // those that still have their frames
  Result<std::vector<std::string>> upload_ids() const;
  // Removes the partial files that a crash while writing has left among the files of a scan, and
  // returns their number. Call it only while nothing is written there.
  int remove_unfinished_files(const std::string& scan_id) const;

 private:
  const std::string path_;
  const FolderLock lock_;
  const SetAsideFiles set_aside_;
  std::string token_;
};

}  // namespace hermite::server
