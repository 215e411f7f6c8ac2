// The file of an upload, written from front to back. Once sync() has succeeded, the bytes survive
// the death of this process, and that of the machine if its disk honours syncs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace hermite::server {

// Owns the descriptor. Blocks on the disk; one thread at a time.
class UploadFile {
 public:
  static Result<UploadFile> create(const std::string& path);  // mode 0600; must not exist. kIo
  static Result<UploadFile> open(const std::string& path);    // kNotFound, kIo
  ~UploadFile();
  UploadFile(UploadFile&& other) noexcept;
  UploadFile& operator=(UploadFile&&) = delete;

  std::int64_t size_bytes() const { return size_bytes_; }

  // Appends. After an error, part of `bytes` may have been written, as size_bytes() says. kIo, with
  // its own message for a full disk.
  Status append(std::string_view bytes);
  // Truncates to that size, which must not exceed the present one.
  Status cut(std::int64_t size_bytes);
  Status sync();  // contents and size

 private:
  explicit UploadFile(int descriptor, std::int64_t size_bytes)
      : descriptor_(descriptor), size_bytes_(size_bytes) {}

  int descriptor_;
  std::int64_t size_bytes_;
};

// Returns the size of the file of an upload. kNotFound, kIo.
Result<std::int64_t> upload_size_bytes(const std::string& path);

// Succeeds if there is no such file. kIo.
Status remove_upload_file(const std::string& path);

}  // namespace hermite::server
