#include "core/dataset/byte_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <utility>

namespace hermite::dataset {

static_assert(std::endian::native == std::endian::little, "fields are read as memory lies");

Result<ByteFile> ByteFile::open(const std::string& path) {
  // Opened without blocking, because the path may be a FIFO.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0)
    return Error{errno == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo,
                 fmt::format("cannot read {}: {}", path, std::strerror(errno))};
  ByteFile file(path, descriptor, 0);
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
    return Error{ErrorCode::kIo, path + " is not a file"};
  file.bytes_ = static_cast<std::uint64_t>(status.st_size);
  return file;
}

ByteFile::~ByteFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

ByteFile::ByteFile(ByteFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      bytes_(other.bytes_) {}

Status ByteFile::read_into(std::uint64_t offset, void* to, std::size_t count) const {
  if (offset > bytes_ || count > bytes_ - offset)
    return Error{ErrorCode::kCorruptData,
                 fmt::format("offset {}: {} bytes are needed, the file has {} in all", offset,
                             count, bytes_)};
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got = pread(descriptor_, static_cast<char*>(to) + done, count - done,
                              static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      return Error{ErrorCode::kIo,
                   fmt::format("cannot read {} at offset {}", path_, offset + done)};
    done += static_cast<std::size_t>(got);
  }
  return Done{};
}

Result<std::vector<std::uint8_t>> ByteFile::read(const FilePart& part) const {
  if (part.offset > bytes_ || part.bytes > bytes_ - part.offset) {
    const Status outside = read_into(part.offset, nullptr, part.bytes);
    return outside.error();
  }
  std::vector<std::uint8_t> bytes(part.bytes);
  if (const Status status = read_into(part.offset, bytes.data(), bytes.size()); !status.ok())
    return status.error();
  return bytes;
}

Error FieldReader::error(const char* field, const std::string& message) const {
  return {ErrorCode::kCorruptData, fmt::format("offset {}: {} {}", last_offset_, field, message)};
}

Status FieldReader::take(const char* field, void* to, std::size_t count) {
  last_offset_ = offset_;
  if (count > remaining())
    return error(field, fmt::format("is cut: the file ends after {} bytes", file_.bytes()));
  if (const Status status = file_.read_into(offset_, to, count); !status.ok()) return status;
  offset_ += count;
  return Done{};
}

Result<FilePart> FieldReader::skip(const char* length_field, std::int64_t bytes,
                                   std::int64_t min_bytes, std::int64_t max_bytes) {
  if (bytes < min_bytes || bytes > max_bytes)
    return error(length_field,
                 fmt::format("is {}, allowed is {} to {}", bytes, min_bytes, max_bytes));
  const auto length = static_cast<std::uint64_t>(bytes);
  if (length > remaining())
    return error(length_field, fmt::format("is {}, but only {} bytes follow", bytes, remaining()));
  const FilePart part{offset_, length};
  offset_ += length;
  return part;
}

}  // namespace hermite::dataset
