// The bytes of one upload on disk, written from front to back. What sync() has returned well for survives the death of this process, and
// that of the machine if its disk keeps its word.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace hermite {

// Owns the descriptor. Blocks on the disk; one thread at a time.
class UploadFile {
 public:
  static Result<UploadFile> create(const std::string& path);  // mode 0600; must not exist. kIo
  static Result<UploadFile> open(const std::string& path);    // kNotFound, kIo
  ~UploadFile();
  UploadFile(UploadFile&& other) noexcept;
  UploadFile& operator=(UploadFile&&) = delete;

  std::int64_t size_bytes() const { return size_bytes_; }

  // Behind all that is there. After an error as much of it may be there as size_bytes() says. kIo, in words for a full disk.
  Status append(std::string_view bytes);
  Status cut(std::int64_t size_bytes);  // to that size, which is not more than there is
  Status sync();                        // of contents and size

 private:
  explicit UploadFile(int descriptor, std::int64_t size_bytes) : descriptor_(descriptor), size_bytes_(size_bytes) {}

  int descriptor_;
  std::int64_t size_bytes_;
};

// How much of the upload is there. kNotFound, kIo.
Result<std::int64_t> upload_size_bytes(const std::string& path);

// Well, too, when it is gone. kIo.
Status remove_upload_file(const std::string& path);

}  // namespace hermite
