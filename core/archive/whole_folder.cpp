#include "core/archive/whole_folder.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

namespace hermite::archive {
namespace {

namespace fs = std::filesystem;

Error folder_failure(const std::string& message) {
  return {ErrorCode::kIo, message + ": " + std::strerror(errno)};
}

// Of the whole file system, since one call for each of many files takes as long as all of them.
Status sync_all_of(const std::string& path) {
  const OpenFile folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.descriptor() < 0 || ::syncfs(folder.descriptor()) != 0)
    return folder_failure(fmt::format("bringing {} to the disk", path));
  return Done{};
}

}  // namespace

WholeFolder::WholeFolder(std::string path, std::string growing, FreshFolder folder)
    : path_(std::move(path)), growing_(std::move(growing)), folder_(std::move(folder)) {}

WholeFolder::WholeFolder(WholeFolder&& other) noexcept
    : path_(std::move(other.path_)),
      growing_(std::exchange(other.growing_, {})),
      folder_(std::move(other.folder_)) {}

WholeFolder::~WholeFolder() {
  std::error_code ignored;
  if (!growing_.empty()) fs::remove_all(growing_, ignored);
}

Result<WholeFolder> WholeFolder::make(const std::string& given) {
  // Two threads of one process must not meet in one folder.
  static std::atomic<std::uint64_t> count = 0;
  std::string path = given;
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  std::error_code error;
  const fs::file_status there = fs::symlink_status(path, error);
  const bool is_free = there.type() == fs::file_type::not_found ||
                       (fs::is_directory(there) && fs::is_empty(path, error));
  if (path.empty() || !is_free)
    return Error{ErrorCode::kInvalidArgument,
                 path + ": there is something already, a new folder is needed"};
  const fs::path parent = fs::path(path).parent_path();
  if (!parent.empty() && !fs::is_directory(parent, error))
    return Error{ErrorCode::kNotFound,
                 fmt::format("{}: there is no folder {} to put it into", path, parent.string())};
  const std::string growing = fmt::format("{}.{}-{}.tmp", path, ::getpid(), count++);
  Result<FreshFolder> folder = FreshFolder::open(growing);
  if (!folder.ok()) return folder.error();
  return WholeFolder(std::move(path), growing, *std::move(folder));
}

Status WholeFolder::write(const std::vector<std::string>& parts,
                          std::span<const std::uint8_t> bytes) const {
  const Result<OpenFile> file = folder_.create(parts);
  const Status status = file.ok() ? file->write(bytes) : Status(file.error());
  return status.ok() ? status : in_context(path_ + ": " + parts.back(), status.error());
}

Status WholeFolder::write(const std::vector<std::string>& parts, const std::string& bytes) const {
  return write(parts, std::span(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
}

Status WholeFolder::finish() {
  CHECK(!growing_.empty(), "a folder is finished once");
  if (const Status synced = sync_all_of(growing_); !synced.ok()) return synced;
  if (std::rename(growing_.c_str(), path_.c_str()) != 0) {
    if (errno == ENOTEMPTY || errno == EEXIST || errno == ENOTDIR)
      return Error{ErrorCode::kInvalidArgument,
                   path_ + ": something else came there in the meantime"};
    return folder_failure(fmt::format("moving {} to {}", growing_, path_));
  }
  growing_.clear();
  const std::string parent = fs::path(path_).parent_path().string();
  const OpenFile folder(
      ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.descriptor() < 0 || ::fsync(folder.descriptor()) != 0)
    return folder_failure(fmt::format("bringing {} to the disk", path_));
  return Done{};
}

}  // namespace hermite::archive
