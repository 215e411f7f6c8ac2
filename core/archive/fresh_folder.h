// A folder for files whose names are a stranger's: nothing is written outside it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite::archive {

// An open file descriptor, closed with its owner. Movable.
class OpenFile {
 public:
  explicit OpenFile(int descriptor = -1) : descriptor_(descriptor) {}
  ~OpenFile();
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&& other) noexcept;
  int descriptor() const { return descriptor_; }
  // Appends all of the bytes. kIo.
  Status write(std::span<const std::uint8_t> bytes) const;

 private:
  int descriptor_;
};

// Every step goes from folder to folder by descriptor and follows no link. One thread at a time.
class FreshFolder {
 public:
  // Makes the folder if it does not exist. kIo; kInvalidArgument when it is not empty.
  static Result<FreshFolder> open(const std::string& path);

  // Creates a file for writing, and the folders in its path. `parts` are those of
  // safe_entry_parts(), at least one (CHECK). kInvalidArgument when the file exists, or a file is
  // where a folder is needed; kIo.
  Result<OpenFile> create(const std::vector<std::string>& parts) const;
  Status make_folder(const std::vector<std::string>& parts) const;

  // Removes all that is in it; the folder stays.
  void clear() const;

 private:
  FreshFolder(std::string path, OpenFile root) : path_(std::move(path)), root_(std::move(root)) {}
  Result<OpenFile> descend(const std::vector<std::string>& parts, std::size_t count) const;

  std::string path_;
  OpenFile root_;
};

// A folder of its own in the system's folder for temporary files ($TMPDIR), removed with everything
// in it. Movable.
class TemporaryFolder {
 public:
  static Result<TemporaryFolder> make();
  ~TemporaryFolder();
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::move(other.path_)) {
    other.path_.clear();
  }
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  const std::string& path() const { return path_; }

 private:
  explicit TemporaryFolder(std::string path) : path_(std::move(path)) {}
  std::string path_;
};

}  // namespace hermite::archive
