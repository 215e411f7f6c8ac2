// Writes a piece of an upload into its file, with the checksum of the piece and the digest of all
// that has come. Made by Uploads on the network thread; its functions say on which thread they are
// called.
#pragma once

#include <openssl/evp.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "core/base/result.h"
#include "server/store/upload_file.h"
#include "server/uploads/tus.h"

namespace hermite::server {

// A piece of an upload that a client sends.
struct UploadPiece {
  std::int64_t offset_bytes = 0;
  std::int64_t length_bytes = 0;
  std::optional<Checksum> checksum;
  // Sent in one request, perhaps as a second attempt: then a finished job of the same bytes is its
  // answer, too.
  bool is_whole = false;
};

// SHA-256 of the first `size_bytes` of an upload. Without a context it is unknown (after a restart,
// or after a piece was discarded).
struct UploadDigest {
  std::int64_t size_bytes = 0;
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context{nullptr, EVP_MD_CTX_free};
};

// The writer of an upload, of which there is at most one at a time. Destroyed on the network
// thread.
class UploadWriter {
 public:
  // `before`: digest of the bytes before the piece, or unknown.
  UploadWriter(UploadFile file, UploadPiece piece, UploadDigest before,
               std::function<Result<std::uint64_t>()> free_bytes, std::uint64_t min_free_bytes);
  ~UploadWriter();
  UploadWriter(const UploadWriter&) = delete;
  UploadWriter& operator=(const UploadWriter&) = delete;

  // The next two functions are called on a disk thread, one call at a time.

  // kIo, kTooLarge (more than announced), kBusy (disk nearly full).
  Status write(std::string_view bytes);
  // Syncs. Discards a piece with a checksum if that does not match or the piece is incomplete. If
  // this succeeds, what remains is durable.
  Status close(bool complete);

  // After close().
  std::int64_t offset_bytes() const { return file_.size_bytes(); }
  UploadDigest take_digest();  // of the whole file, or unknown
  bool is_whole() const { return piece_.is_whole; }

  // On the network thread. is_idle(): nothing was received for so long that the connection may be
  // dead.
  bool is_idle() const;
  bool wanted() const { return wanted_; }
  void on_unwanted(std::function<void()> run) { on_unwanted_ = std::move(run); }
  void give_up();

 private:
  Status check_sum();
  void begin_digest(std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)>& digest,
                    const EVP_MD* kind) const;

  UploadFile file_;
  const UploadPiece piece_;
  const std::function<Result<std::uint64_t>()> free_bytes_;
  const std::uint64_t min_free_bytes_;
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> digest_;  // of the piece, if it has a checksum
  UploadDigest content_;
  std::int64_t unsynced_bytes_ = 0;
  std::atomic<std::chrono::steady_clock::time_point> written_at_ = std::chrono::steady_clock::now();
  bool wanted_ = true;
  std::function<void()> on_unwanted_;
};

}  // namespace hermite::server
