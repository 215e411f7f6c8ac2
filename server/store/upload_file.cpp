#include "server/store/upload_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "core/base/check.h"
#include "core/base/sync_path.h"

namespace hermite::server {

namespace {

constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW;

Error io_error(const std::string& what) {
  return {errno == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo,
          what + ": " + std::strerror(errno)};
}

}  // namespace

Result<UploadFile> UploadFile::create(const std::string& path) {
  const int descriptor = ::open(path.c_str(), kFlags | O_CREAT | O_EXCL, 0600);
  if (descriptor < 0) return io_error("creating the file of an upload");
  UploadFile file(descriptor, 0);
  // The bytes are of no use unless the name of the file is durable too.
  if (Status status = sync_path(std::filesystem::path(path).parent_path()); !status.ok()) {
    unlink(path.c_str());
    return status.error();
  }
  return file;
}

Result<UploadFile> UploadFile::open(const std::string& path) {
  const int descriptor = ::open(path.c_str(), kFlags);
  if (descriptor < 0) return io_error("opening the file of an upload");
  UploadFile file(descriptor, 0);
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
    return io_error("looking at the file of an upload");
  file.size_bytes_ = status.st_size;
  return file;
}

UploadFile::~UploadFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

UploadFile::UploadFile(UploadFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), size_bytes_(other.size_bytes_) {}

Status UploadFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = pwrite(descriptor_, bytes.data(), bytes.size(), size_bytes_);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      return Error{ErrorCode::kIo,
                   std::string("the upload cannot be written: ") + std::strerror(errno)};
    size_bytes_ += count;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return Done{};
}

Status UploadFile::cut(std::int64_t size_bytes) {
  CHECK(size_bytes >= 0 && size_bytes <= size_bytes_, "an upload is cut, not filled up");
  if (ftruncate(descriptor_, size_bytes) != 0) return io_error("cutting the file of an upload");
  size_bytes_ = size_bytes;
  return Done{};
}

Status UploadFile::sync() {
  if (fdatasync(descriptor_) != 0)
    return Error{ErrorCode::kIo,
                 std::string("the upload cannot be stored: ") + std::strerror(errno)};
  return Done{};
}

Result<std::int64_t> upload_size_bytes(const std::string& path) {
  struct stat status {};
  if (lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode))
    return io_error("looking at the file of an upload");
  return static_cast<std::int64_t>(status.st_size);
}

Status remove_upload_file(const std::string& path) {
  if (unlink(path.c_str()) != 0 && errno != ENOENT)
    return io_error("removing the file of an upload");
  return Done{};
}

}  // namespace hermite::server
