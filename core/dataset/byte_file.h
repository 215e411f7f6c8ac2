// A file of bytes that is read at positions given in the file itself: every length is checked
// against the file before memory is allocated.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/result.h"

namespace hermite::dataset {

struct FilePart {
  std::uint64_t offset = 0, bytes = 0;
};

// Movable. Const functions are thread-safe.
class ByteFile {
 public:
  // Returns kNotFound; kIo, also when it is not a regular file.
  static Result<ByteFile> open(const std::string& path);
  ~ByteFile();
  ByteFile(ByteFile&& other) noexcept;
  ByteFile& operator=(ByteFile&&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t bytes() const { return bytes_; }

  // Return kCorruptData when the part exceeds the file, naming offset and both lengths; kIo.
  Result<std::vector<std::uint8_t>> read(const FilePart& part) const;
  Status read_into(std::uint64_t offset, void* to, std::size_t count) const;

 private:
  ByteFile(std::string path, int descriptor, std::uint64_t bytes)
      : path_(std::move(path)), descriptor_(descriptor), bytes_(bytes) {}

  std::string path_;
  int descriptor_;
  std::uint64_t bytes_;
};

// Reads consecutive little-endian fields. Errors have the form "offset 8: num_frames ...". One
// thread at a time.
class FieldReader {
 public:
  explicit FieldReader(const ByteFile& file) : file_(file) {}

  std::uint64_t offset() const { return offset_; }
  std::uint64_t remaining() const { return file_.bytes() - offset_; }

  template <class Value>
  Result<Value> read(const char* field) {
    static_assert(std::is_trivially_copyable_v<Value>);
    Value value{};
    if (const Status status = take(field, &value, sizeof value); !status.ok())
      return status.error();
    return value;
  }

  // Skips the next `bytes` bytes and returns their place in the file. `length_field` is the field
  // that gave the number.
  Result<FilePart> skip(const char* length_field, std::int64_t bytes, std::int64_t min_bytes,
                        std::int64_t max_bytes);

  // Returns an error "offset 8: field ..." for the field that was read last.
  Error error(const char* field, const std::string& message) const;

 private:
  Status take(const char* field, void* to, std::size_t count);

  const ByteFile& file_;
  std::uint64_t offset_ = 0, last_offset_ = 0;
};

}  // namespace hermite::dataset
