// Recordings on their way to the server: who may send how much, how much has come, and the one who writes. Belongs to the network thread;
// only UploadWriter has functions for another one.
//
// An upload is a row and a file. How much has come is the file's length, which is only told while nobody writes: then all of it is synced.
#pragma once

#include <openssl/evp.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "server/access/gate.h"
#include "server/disk/storage.h"
#include "server/store/unix_time.h"
#include "server/store/upload_file.h"
#include "server/uploads/tus.h"

namespace hermite {

struct UploadLimits {
  std::int64_t upload_bytes = std::int64_t{20} << 30;
  std::int64_t token_bytes = std::int64_t{20} << 30;  // of all uploads of one token that may not administer; 0: as much as there is
  std::uint64_t min_free_disk_bytes = 0;              // that must remain
  std::int64_t keep_ms = kDay_ms;                     // after something has happened with it last
};

struct UploadState {
  UploadRow row;
  std::int64_t offset_bytes = 0;  // so much is on disk; -1: somebody writes, and what has come is not told
  bool complete() const { return offset_bytes == row.length_bytes; }
  std::string job_id = {};  // of the upload that has the same bytes and came first; empty: its own
};

// A piece of an upload that somebody sends.
struct UploadPiece {
  std::int64_t offset_bytes = 0;
  std::int64_t length_bytes = 0;
  std::optional<Checksum> checksum;
  bool is_whole = false;  // in one request, which may be a second try: then a job of the same bytes that has finished is its answer, too
};

// SHA-256 of what has come of an upload so far: so many bytes. Nothing in it: that is not known (after a restart, or a piece taken back).
struct UploadDigest {
  std::int64_t size_bytes = 0;
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context{nullptr, EVP_MD_CTX_free};
};

// Who writes an upload: there is one at a time. Destroyed on the network thread.
class UploadWriter {
 public:
  // `before`: of the bytes before the piece, or nothing.
  UploadWriter(UploadFile file, UploadPiece piece, UploadDigest before, std::function<Result<std::uint64_t>()> free_bytes,
               std::uint64_t min_free_bytes);
  ~UploadWriter();
  UploadWriter(const UploadWriter&) = delete;
  UploadWriter& operator=(const UploadWriter&) = delete;

  // On a thread for the disk, one call at a time.
  Status write(std::string_view bytes);  // kIo, kTooLarge (more than announced), kBusy (disk nearly full)
  // Syncs, and takes back what its checksum does not fit or has not come as a whole. What is left is durable if this is well.
  Status close(bool complete);

  // After close().
  std::int64_t offset_bytes() const { return file_.size_bytes(); }
  UploadDigest take_digest();  // of all that is there, or nothing
  bool is_whole() const { return piece_.is_whole; }

  // On the network thread. Idle: nothing has come for so long that its connection may be dead.
  bool is_idle() const;
  bool wanted() const { return wanted_; }
  void on_unwanted(std::function<void()> run) { on_unwanted_ = std::move(run); }
  void give_up();

 private:
  Status check_sum();
  void begin_digest(std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)>& digest, const EVP_MD* kind) const;

  UploadFile file_;
  const UploadPiece piece_;
  const std::function<Result<std::uint64_t>()> free_bytes_;
  const std::uint64_t min_free_bytes_;
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> digest_;  // of the piece, where it has a checksum
  UploadDigest content_;
  std::int64_t unsynced_bytes_ = 0;
  std::atomic<std::chrono::steady_clock::time_point> written_at_ = std::chrono::steady_clock::now();
  bool wanted_ = true;
  std::function<void()> on_unwanted_;
};

class Uploads {
 public:
  // Takes back what a dead server has not checked, and syncs all files. `complete` is told of uploads that are whole, after a start once
  // more of those that were before. What is in `storage` outlives this. Throws SetupError.
  Uploads(UploadLimits limits, const Storage& storage, std::function<Status(const UploadRow&)> complete);

  // kTooLarge: more than an upload may have. kBusy: a quota or the disk is used up, in words.
  Result<UploadState> create(std::int64_t length_bytes, const std::string& metadata, const Grant& grant, std::int64_t now_ms);

  // kNotFound: none, an expired one, or somebody else's.
  Result<UploadState> find(const std::string& id, const Grant& grant, std::int64_t now_ms);

  // False: somebody writes it; ask again soon. Before anything is told of it or done with it. Who writes is asked to stop when nothing has
  // come for a second, or `at_once`: of many who want to go on with it at the same time one gets through.
  bool is_free(const std::string& id, bool at_once = false);

  // Of an upload that is free. kInvalidArgument: another offset than there is; kTooLarge: beyond its length; kBusy as in create().
  Result<std::shared_ptr<UploadWriter>> write(const UploadState& state, const UploadPiece& piece, const Grant& grant);

  // When its writer has closed the file, before it goes. Tells of an upload that is whole; a whole one whose bytes and metadata are those
  // of one of the same token whose job has not ended is removed again and named after that; one that came in one request also after one
  // whose job has left a scan that is still there.
  Result<UploadState> written(const UploadState& state, UploadWriter& writer, std::int64_t now_ms);

  // The id of the job that stands for an upload: its own, or that of the one with the same bytes that came first. For as long as this
  // server runs.
  std::string job_of(const std::string& id) const;

  Status set_length(UploadState& state, std::int64_t length_bytes, const Grant& grant);  // of one that had none. Errors as in create()
  // kNotFound as in find(); kBusy: its job has not ended.
  Status remove(const std::string& id, const Grant& grant, std::int64_t now_ms);
  Result<std::vector<UploadState>> list(const Grant& grant);  // oldest first

  void forget(const std::string& id);                     // well used: its bytes go
  void keep(const std::string& id, std::int64_t now_ms);  // used in vain: it expires from now on
  void sweep(std::int64_t now_ms);                        // removes what has expired and waits for no job

  const UploadLimits& limits() const { return limits_; }

 private:
  Status check_room(std::int64_t more_bytes, const std::string& except_id, const Grant& grant);
  Status check_storage(std::int64_t more_bytes, const std::string& except_id, const std::vector<UploadRow>& rows, const Grant& grant) const;
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
  std::map<std::string, UploadDigest> digests_;                 // by id: of uploads that nobody writes and that are not whole
  std::map<std::string, std::string> twins_;                    // by id, of uploads that were removed for another one: that one's id
  std::map<std::string, std::string> whole_ones_;               // ids, by token, metadata and content
};

}  // namespace hermite
