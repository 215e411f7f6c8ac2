// Uploads of recordings: their quotas, their progress, and the one writer of each. Belongs to the
// network thread; only UploadWriter (upload_writer.h) has functions for another one.
//
// An upload is a row and a file. Its progress is the length of the file, which is only reported
// while nobody writes; then all of it is synced.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/access/gate.h"
#include "server/disk/storage.h"
#include "server/store/unix_time.h"
#include "server/store/upload_row.h"
#include "server/uploads/upload_writer.h"

namespace hermite::server {

struct UploadLimits {
  std::int64_t upload_bytes = std::int64_t{20} << 30;
  // All uploads of a token without the scope admin; 0: no limit but the disk's.
  std::int64_t token_bytes = std::int64_t{20} << 30;
  std::uint64_t min_free_disk_bytes = 0;  // must remain free
  std::int64_t keep_ms = kDay_ms;         // after its last use
};

struct UploadState {
  UploadRow row;
  // Bytes on disk; -1: it is being written, and the offset is not reported.
  std::int64_t offset_bytes = 0;
  bool complete() const { return offset_bytes == row.length_bytes; }
  std::string job_id = {};  // of an earlier upload with the same bytes; empty: it has its own job
};

class Uploads {
 public:
  // Discards unchecked bytes that a crashed server has left, and syncs all files. `complete` is
  // called for every complete upload, and after a start once more for those completed before. The
  // members of `storage` outlive this. Throws SetupError.
  Uploads(UploadLimits limits, const Storage& storage,
          std::function<Status(const UploadRow&)> complete);

  // kTooLarge: more than an upload may have. kBusy: a quota or the disk is used up, with a message.
  Result<UploadState> create(std::int64_t length_bytes, const std::string& metadata,
                             const Grant& grant, std::int64_t now_ms);

  // kNotFound: it does not exist, has expired, or belongs to another token.
  Result<UploadState> find(const std::string& id, const Grant& grant, std::int64_t now_ms);

  // Returns false while the upload is being written; then ask again soon. Check it before the
  // upload is reported or changed. The writer is asked to stop if it has received nothing for a
  // second or, with `at_once`, always; so of several clients that want to resume it at the same
  // time one succeeds.
  bool is_free(const std::string& id, bool at_once = false);

  // Starts a piece of an upload for which is_free() is true. kInvalidArgument: not at the current
  // offset; kTooLarge: beyond its length; kBusy as in create().
  Result<std::shared_ptr<UploadWriter>> write(const UploadState& state, const UploadPiece& piece,
                                              const Grant& grant);

  // Call it after the writer has closed the file and before it is destroyed. Calls `complete` for a
  // complete upload, unless it is a duplicate: if the bytes and metadata are those of an earlier
  // upload of the same token whose job has not ended, it is removed, and job_id names that job. For
  // an upload that came in one request, this also holds if the earlier job has finished and its
  // scan still exists.
  Result<UploadState> written(const UploadState& state, UploadWriter& writer, std::int64_t now_ms);

  // Returns the id of the job of an upload: its own, or that of the earlier upload with the same
  // bytes. Duplicates are remembered while this server runs, but not more than 1000.
  std::string job_of(const std::string& id) const;

  // Sets the length of an upload without one. Errors as in create().
  Status set_length(UploadState& state, std::int64_t length_bytes, const Grant& grant);
  // kNotFound as in find(); kBusy: its job has not ended.
  Status remove(const std::string& id, const Grant& grant, std::int64_t now_ms);
  Result<std::vector<UploadState>> list(const Grant& grant);  // oldest first

  // Removes it with its bytes: its job has succeeded, or nobody can resume it.
  void forget(const std::string& id);
  // Its job has failed: keeps it for keep_ms.
  void keep(const std::string& id, std::int64_t now_ms);
  // Removes expired uploads for which no job waits.
  void sweep(std::int64_t now_ms);

  const UploadLimits& limits() const { return limits_; }

 private:
  Status check_room(std::int64_t more_bytes, const std::string& except_id, const Grant& grant);
  Status check_storage(std::int64_t more_bytes, const std::string& except_id,
                       const std::vector<UploadRow>& rows, const Grant& grant) const;
  Result<std::int64_t> recover(UploadRow row);
  bool is_written(const std::string& id) const;
  bool has_waiting_job(const std::string& id);
  std::int64_t size_of(const std::string& id) const;

  const UploadLimits limits_;
  const Storage storage_;
  const DataDirectory& data_;
  Store& store_;
  const std::function<Status(const UploadRow&)> complete_;
  std::string twin_of(const UploadRow& row, UploadDigest digest, bool is_whole);

  std::map<std::string, std::weak_ptr<UploadWriter>> writers_;  // by id
  // By id, digests of incomplete uploads that are not being written.
  std::map<std::string, UploadDigest> digests_;
  // Job ids by upload id, of uploads that were removed as duplicates.
  std::map<std::string, std::string> twins_;
  // Ids by token, metadata and content.
  std::map<std::string, std::string> whole_ones_;
};

}  // namespace hermite::server
