// A folder as a tar, byte by byte on demand: nothing is copied to the disk first, and any part can
// be read again, so that an upload of it can be gone on with. The same files give the same bytes:
// sorted by name, without times, owners and modes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite::archive {

// Const functions are thread-safe.
class TarStream {
 public:
  // Regular files below `folder`, inside a folder of its name; others are left out. Names keep the
  // rules of entry_name.h. kNotFound; kInvalidArgument: a name that unpacking would refuse, or that
  // is too long for a ustar header; kTooLarge: more files than UnpackLimits allow, or one of 8 GiB;
  // kIo.
  static Result<TarStream> open(const std::string& folder);

  std::int64_t size_bytes() const { return size_bytes_; }
  std::int64_t file_count() const { return static_cast<std::int64_t>(members_.size()); }
  // Returns the fingerprint of names, sizes and times of change.
  const std::string& fingerprint() const { return fingerprint_; }

  // `count` bytes from `offset` on, fewer at the end. kIo: a file is gone or has another size now.
  Result<std::string> read(std::int64_t offset, std::int64_t count) const;

 private:
  struct Member {
    std::string path;        // on the disk
    std::string header;      // 512 bytes
    std::int64_t begin = 0;  // of the header, in the tar
    std::int64_t size_bytes = 0;
  };
  Status add(const std::string& path, const std::string& name);

  std::vector<Member> members_;
  std::int64_t size_bytes_ = 0;
  std::string fingerprint_;
};

}  // namespace hermite::archive
