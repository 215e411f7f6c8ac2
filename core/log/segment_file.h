// One segment of a frame log, to be read (format: frame_log.md). Header only; for readers of this
// folder.
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "core/base/result.h"
#include "core/log/frame_log_format.h"

namespace hermite::frame_log {

// Call from one thread.
class SegmentFile {
 public:
  // Null: there is no such segment. kIo.
  static Result<std::unique_ptr<SegmentFile>> open(const std::string& folder,
                                                   std::uint32_t segment) {
    const std::string path = folder + "/" + segment_name(segment);
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor < 0 && errno == ENOENT) return std::unique_ptr<SegmentFile>();
    if (descriptor < 0) return failure("opening " + path);
    std::unique_ptr<SegmentFile> file(new SegmentFile(path, descriptor));
    if (Status status = file->ask_size(); !status.ok()) return status.error();
    return file;
  }
  ~SegmentFile() { close(descriptor_); }
  SegmentFile(const SegmentFile&) = delete;
  SegmentFile& operator=(const SegmentFile&) = delete;

  std::uint64_t size_bytes() const { return size_bytes_; }  // when it was last asked for

  // It may have grown.
  Status ask_size() {
    struct stat status {};
    if (fstat(descriptor_, &status) != 0) return failure("asking for the size of " + path_);
    size_bytes_ = static_cast<std::uint64_t>(status.st_size);
    return Done{};
  }

  // As many bytes from `offset` on as there are, at most `count`. kIo.
  Result<std::string> read(std::uint64_t offset, std::size_t count) {
    if (offset + count > size_bytes_)
      if (Status status = ask_size(); !status.ok()) return status.error();
    std::string bytes(static_cast<std::size_t>(std::min<std::uint64_t>(
                          count, size_bytes_ - std::min(offset, size_bytes_))),
                      '\0');
    for (std::size_t have = 0; have < bytes.size();) {
      const ssize_t got = pread(descriptor_, bytes.data() + have, bytes.size() - have,
                                static_cast<off_t>(offset + have));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return failure("reading " + path_);
      if (got == 0) bytes.resize(have);
      have += static_cast<std::size_t>(got);
    }
    return bytes;
  }

  // Only some bytes here and there will be read: what is between them need not come from the disk.
  void expect_jumps() { posix_fadvise(descriptor_, 0, 0, POSIX_FADV_RANDOM); }

 private:
  SegmentFile(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  static Error failure(const std::string& what) {
    return {ErrorCode::kIo, what + ": " + std::strerror(errno)};
  }

  const std::string path_;
  const int descriptor_;
  std::uint64_t size_bytes_ = 0;
};

}  // namespace hermite::frame_log
