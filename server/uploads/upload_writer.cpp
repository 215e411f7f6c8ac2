#include "server/uploads/upload_writer.h"

#include <fmt/core.h>

#include <string>
#include <utility>

#include "core/base/check.h"

namespace hermite::server {

namespace {

// A client on a working link sends something every second; one that returns after its link has died
// should not wait for long.
constexpr std::chrono::seconds kIdleAfter(1);
// Bytes of one upload that may wait in the page cache.
constexpr std::int64_t kSyncBytes = 16 * 1024 * 1024;

}  // namespace

UploadWriter::UploadWriter(UploadFile file, UploadPiece piece, UploadDigest before,
                           std::function<Result<std::uint64_t>()> free_bytes,
                           std::uint64_t min_free_bytes)
    : file_(std::move(file)),
      piece_(std::move(piece)),
      free_bytes_(std::move(free_bytes)),
      min_free_bytes_(min_free_bytes),
      digest_(nullptr, EVP_MD_CTX_free),
      content_(std::move(before)) {
  if (piece_.checksum)
    begin_digest(digest_, piece_.checksum->algorithm == ChecksumAlgorithm::kSha1 ? EVP_sha1()
                                                                                 : EVP_sha256());
  if (piece_.offset_bytes == 0) begin_digest(content_.context, EVP_sha256());
}

void UploadWriter::begin_digest(std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)>& digest,
                                const EVP_MD* kind) const {
  digest.reset(EVP_MD_CTX_new());
  CHECK(digest && EVP_DigestInit_ex(digest.get(), kind, nullptr) == 1,
        "SHA-1 and SHA-256 are always there");
}

bool UploadWriter::is_idle() const {
  return std::chrono::steady_clock::now() - written_at_.load() >= kIdleAfter;
}

UploadWriter::~UploadWriter() = default;

Status UploadWriter::write(std::string_view bytes) {
  if (file_.size_bytes() + static_cast<std::int64_t>(bytes.size()) >
      piece_.offset_bytes + piece_.length_bytes)
    return Error{
        ErrorCode::kTooLarge,
        fmt::format("more has come than the {} bytes that were announced", piece_.length_bytes)};
  for (EVP_MD_CTX* const digest : {digest_.get(), content_.context.get()})
    if (digest)
      CHECK(EVP_DigestUpdate(digest, bytes.data(), bytes.size()) == 1, "a digest takes any bytes");
  content_.size_bytes += static_cast<std::int64_t>(bytes.size());
  written_at_ = std::chrono::steady_clock::now();
  if (Status status = file_.append(bytes); !status.ok()) return status;
  unsynced_bytes_ += static_cast<std::int64_t>(bytes.size());
  if (unsynced_bytes_ < kSyncBytes) return Done{};
  unsynced_bytes_ = 0;
  // Others fill the same disk meanwhile.
  if (const Result<std::uint64_t> free = free_bytes_(); free.ok() && *free < min_free_bytes_)
    return Error{ErrorCode::kBusy,
                 fmt::format("the disk is nearly full: {} MB are free", *free / 1'000'000)};
  return file_.sync();
}

Status UploadWriter::check_sum() {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  CHECK(EVP_DigestFinal_ex(digest_.get(), digest, &size) == 1, "a digest has an end");
  if (std::string_view(reinterpret_cast<const char*>(digest), size) == piece_.checksum->digest)
    return Done{};
  return Error{ErrorCode::kCorruptData,
               "the piece does not have the checksum that Upload-Checksum says; it was not taken"};
}

Status UploadWriter::close(bool complete) {
  Status verdict = Done{};
  if (digest_) {
    verdict = complete ? check_sum()
                       : Error{ErrorCode::kCorruptData,
                               "the piece was cut, so that its checksum cannot be checked"};
    if (!verdict.ok())
      if (Status cut = file_.cut(piece_.offset_bytes); !cut.ok()) return cut;
  }
  if (Status synced = file_.sync(); !synced.ok()) {
    // It is unknown what a failed fdatasync has lost, but earlier bytes were synced.
    if (Status cut = file_.cut(piece_.offset_bytes); !cut.ok()) return cut;
    return synced;
  }
  return verdict;
}

// If bytes were written in vain or discarded, the digest includes them all the same, so it does not
// match the file and is dropped.
UploadDigest UploadWriter::take_digest() {
  if (content_.size_bytes != file_.size_bytes()) content_.context.reset();
  return std::exchange(content_, {});
}

void UploadWriter::give_up() {
  wanted_ = false;
  if (const std::function<void()> run = std::exchange(on_unwanted_, nullptr)) run();
}

}  // namespace hermite::server
