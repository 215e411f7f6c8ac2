// The folder that is one server's memory:
//
//   lock          held (flock) for as long as the server runs, so that two programs never share a folder; the server's address is in it
//   token         the first token: 64 hex digits, mode 0600
//   hermite.db    scans, tokens, uploads and jobs (sqlite_store.h)
//   scans/ID/     cloud.ply surfels.ply trajectory.txt tracking.txt report.json chunks.bin of an ended scan, and its exports (blobs.h)
//   scans/ID/log/ its frames as they came (frame_log.h)
//   scans/ID/checkpoint.bin  of one that runs: what it has come to (checkpoint_file.h)
//   uploads/ID    the bytes of an upload, as far as they have come
//   jobs/ID/      what a running job has unpacked; empty at every start
//   waste/        what was removed, until the disk has let go of it
//   restore.unfinished  a restore was cut off: no server starts here
//   probe         comes and goes: whether the disk takes anything
//   lost/         scans/ID and uploads/ID that no row knew at a start (orphans.h)
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite {

// In a folder that a backup is being restored into (backup.h).
inline constexpr const char* kRestoreMark = "restore.unfinished";

// In audit/ (server/access/audit.h): of the folder it is copied first, so that a backup of a server that runs says of no entry that it is
// missing.
inline constexpr const char *kAuditFolder = "audit", *kAuditHeadName = "head";

// Owns the lock. One owner; const functions are thread-safe.
class DataDirectory {
 public:
  // Creates the folder (mode 0700; one that is there is closed to other users), takes the lock and reads or makes the token. The folder
  // itself is locked, too: that lock stays when somebody deletes the file. Throws SetupError in words: not writable, in use by another
  // server (kBusy), open to other users and not ours to close, a token file that holds no token, a restore that was cut off. The folders
  // and the token stay from here on, also after a power cut.
  explicit DataDirectory(const std::string& path);
  ~DataDirectory();
  DataDirectory(const DataDirectory&) = delete;
  DataDirectory& operator=(const DataDirectory&) = delete;

  const std::string& token() const { return token_; }
  std::string database_path() const { return path_ + "/hermite.db"; }
  std::string audit_folder() const { return path_ + "/" + kAuditFolder; }
  std::string retention_path() const { return path_ + "/retention"; }

  // Writes where this server listens into the lock file, for programs beside it.
  Status publish_address(const std::string& url) const;

  // Bytes of all files of each scan, by its id. Looks at every file: not for a thread that others wait for. kIo.
  Result<std::map<std::string, std::uint64_t>> scan_sizes() const;

  // Bytes of all uploads but that one. Quick: they are few (kUploadShare). kIo.
  Result<std::uint64_t> uploads_bytes(const std::string& except_upload_id = "") const;

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

  // What is not wanted any more: out of the way at once, so that its id is free, while its bytes go with remove_waste() or in vain, if that
  // never comes, with that of the next server. The name is what it is called as waste; empty: there was nothing. kIo.
  Result<std::string> discard_scan(const std::string& scan_id) const;
  Result<std::string> discard_upload(const std::string& upload_id) const;
  std::vector<std::string> waste() const;              // names
  Status remove_waste(const std::string& name) const;  // as long as a disk takes for gigabytes

  // Ids that have a folder or a file, whether somebody knows them or not. kIo.
  Result<std::vector<std::string>> scan_ids() const;
  Result<std::vector<std::string>> logged_scan_ids() const;  // those that still have their frames
  Result<std::vector<std::string>> upload_ids() const;
  // What a death in the middle of writing has left beside the files of a scan. How many there were. While nobody writes there.
  int remove_unfinished_files(const std::string& scan_id) const;

  // Moves what nobody knows to lost/, from where a person may take it back. kIo, also when one of that id is lost already.
  Status lose_scan(const std::string& scan_id, std::int64_t now_ms) const;
  Status lose_upload(const std::string& upload_id, std::int64_t now_ms) const;
  // Makes waste of what was lost before that time: its places, as a person knows them.
  std::vector<std::string> discard_lost(std::int64_t lost_before_ms) const;

  // Bytes free for us in the file system of this folder. kIo.
  Result<std::uint64_t> free_disk_bytes() const;
  // Bytes that it would have free for us if nothing were stored in it. kIo.
  Result<std::uint64_t> disk_capacity_bytes() const;

 private:
  Result<std::string> discard(const std::string& path) const;
  Status lose(const std::string& place, std::int64_t now_ms) const;

  std::string path_;
  std::string token_;
  int lock_file_ = -1;
  int locked_folder_ = -1;
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

// Makes a file there and removes it. kIo in words: the disk takes none, as one that has become read-only.
Status check_takes_files(const std::string& data_folder);

}  // namespace hermite
