// The folder that holds all data of a server:
//
//   lock          locked (flock) while the server runs, so that two programs never share a folder; holds the server's address
//   token         the first token: 64 hex digits, mode 0600
//   hermite.db    scans, tokens, uploads and jobs (store.h)
//   rows-at       says that these are in PostgreSQL and not here (rows_place.h)
//   scans/ID/     of an ended scan (blobs.h): cloud.ply surfels.ply trajectory.txt tracking.txt thumbnail.jpg report.json chunks.bin, its
//                 edits, its exports
//   scans/ID/log/ the frames of the scan as received (frame_log.h)
//   scans/ID/checkpoint.bin
//                 the state of a running scan (checkpoint_file.h)
//   uploads/ID    the bytes of an upload received so far
//   jobs/ID/      the files that a running job has unpacked; emptied at every start
//   waste/        removed files whose deletion has not finished
//   restore.unfinished
//                 marks an interrupted restore: no server starts here
//   blobs-at      says that the results of scans are in S3 and not here, and where (server/s3/remote_setup.h)
//   blob-removals results that are to be removed from S3 (server/s3/remote_blobs.h)
//   probe         exists briefly, to test whether the disk is writable
//   lost/         scans/ID and uploads/ID that had no row in the database at a start (orphans.h)
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite {

// Name of the mark in a folder into which a backup is being restored (backup.h).
inline constexpr const char* kRestoreMark = "restore.unfinished";

// In audit/ (server/access/audit.h). A backup copies the head before the rest of the folder, so that the backup of a
// running server does not claim entries that it lacks.
inline constexpr const char *kAuditFolder = "audit", *kAuditHeadName = "head";

struct Inodes {
  std::uint64_t free = 0, all = 0;  // both the largest number where the file system has no fixed number of them
};
// For free_bytes(). Most files of scans have more: segments of frame logs, results.
inline constexpr std::uint64_t kBytesPerInode = 1'000'000;

// Holds the lock. One owner; const functions are thread-safe.
class DataDirectory {
 public:
  // Creates the folder with mode 0700, or closes an existing one to other users, takes the lock and reads or creates
  // the token. Also locks the folder itself, a lock that remains when somebody deletes the lock file. Throws
  // SetupError, with a message: not writable, in use by another server (kBusy), open to other users and owned by somebody
  // else, a token file without a token, an interrupted restore. From here on, folders and token survive a power
  // failure.
  explicit DataDirectory(const std::string& path);
  ~DataDirectory();
  DataDirectory(const DataDirectory&) = delete;
  DataDirectory& operator=(const DataDirectory&) = delete;

  const std::string& token() const { return token_; }
  std::string database_path() const { return path_ + "/hermite.db"; }
  std::string audit_folder() const { return path_ + "/" + kAuditFolder; }
  std::string retention_path() const { return path_ + "/retention"; }

  // Writes the address on which this server listens into the lock file, for other programs on this machine.
  Status publish_address(const std::string& url) const;

  // Returns the size of all files of each scan, by its id, in bytes. Looks at every file, so do not call it on a thread
  // that others wait for. kIo.
  Result<std::map<std::string, std::uint64_t>> scan_sizes() const;

  // Returns the size of all uploads except the given one, in bytes. Fast, since there are few (kUploadShare). kIo.
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

  // Moves a folder or file to waste/, which frees its id immediately; remove_waste() deletes it later, here or in the
  // next server. Returns its name in waste/; empty if there was nothing. kIo.
  Result<std::string> discard_scan(const std::string& scan_id) const;
  Result<std::string> discard_upload(const std::string& upload_id) const;
  std::vector<std::string> waste() const;              // names in waste/
  Status remove_waste(const std::string& name) const;  // takes as long as the disk takes to delete gigabytes

  // Returns the ids that have a folder or a file, whether the database has a row for them or not. kIo.
  Result<std::vector<std::string>> scan_ids() const;
  Result<std::vector<std::string>> logged_scan_ids() const;  // those that still have their frames
  Result<std::vector<std::string>> upload_ids() const;
  // Removes the partial files that a crash while writing has left among the files of a scan, and returns their number.
  // Call it only while nothing is written there.
  int remove_unfinished_files(const std::string& scan_id) const;

  // Moves what has no row in the database to lost/, from where an administrator may restore it. kIo, also if that id is
  // in lost/ already.
  Status lose_scan(const std::string& scan_id, std::int64_t now_ms) const;
  Status lose_upload(const std::string& upload_id, std::int64_t now_ms) const;
  // Moves what was lost before that time to waste/. Returns the paths in lost/, relative to this folder.
  std::vector<std::string> discard_lost(std::int64_t lost_before_ms) const;

  // Returns the inodes of the file system of this folder: one for each file and folder. kIo.
  Result<Inodes> inodes() const;

  // Returns the bytes available to this user in the file system of this folder, as free_bytes(). kIo.
  Result<std::uint64_t> free_disk_bytes() const;
  // Returns the bytes that would be available to this user if nothing were stored in the file system. kIo.
  Result<std::uint64_t> disk_capacity_bytes() const;

 private:
  Result<std::string> discard(const std::string& path) const;
  Status lose(const std::string& place, std::int64_t now_ms) const;

  std::string path_;
  std::string token_;
  int lock_file_ = -1;
  int locked_folder_ = -1;
};

// What a program on the same machine needs to connect to a server.
struct PublishedServer {
  std::string url;    // as published
  std::string token;  // the first token
};

// Returns address and token of the server that holds the lock of `path`. kNotFound: no server has published its address
// there, or there is no token. kIo.
Result<PublishedServer> published_server(const std::string& path);

// Returns the bytes available to this user in the file system that holds `path`, which must exist; no more than
// kBytesPerInode for each free inode, so that what keeps bytes free for others also keeps inodes free for them.
Result<std::uint64_t> free_bytes(const std::string& path);

// Creates a file there and removes it. kIo, with a message: the disk is not writable, for example because it has become
// read-only.
Status check_takes_files(const std::string& data_folder);

}  // namespace hermite
