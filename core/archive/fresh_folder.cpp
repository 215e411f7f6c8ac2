#include "core/archive/fresh_folder.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace hermite::archive {
namespace {

constexpr int kFolderFlags = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
constexpr int kNewFileFlags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
constexpr mode_t kFolderMode = 0755, kFileMode = 0644;

Error failure(const std::string& message) {
  return {ErrorCode::kIo, message + ": " + std::strerror(errno)};
}

}  // namespace

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

OpenFile::OpenFile(OpenFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

Status OpenFile::write(std::span<const std::uint8_t> bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return failure("cannot be written");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return Done{};
}

Result<FreshFolder> FreshFolder::open(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error)
    return Error{ErrorCode::kIo, fmt::format("making the folder {}: {}", path, error.message())};
  OpenFile root(::open(path.c_str(), kFolderFlags));
  if (root.descriptor() < 0) return failure("opening the folder " + path);
  if (!std::filesystem::is_empty(path, error) || error)
    return Error{ErrorCode::kInvalidArgument, fmt::format("the folder {} is not empty", path)};
  return FreshFolder(path, std::move(root));
}

// The folder of the first `count` parts, made where it is missing.
Result<OpenFile> FreshFolder::descend(const std::vector<std::string>& parts,
                                      std::size_t count) const {
  OpenFile at(::openat(root_.descriptor(), ".", kFolderFlags));
  for (std::size_t i = 0; at.descriptor() >= 0 && i < count; ++i) {
    if (mkdirat(at.descriptor(), parts[i].c_str(), kFolderMode) != 0 && errno != EEXIST)
      return failure("making the folder " + parts[i]);
    at = OpenFile(::openat(at.descriptor(), parts[i].c_str(), kFolderFlags));
    if (at.descriptor() < 0 && (errno == ENOTDIR || errno == ELOOP))
      return Error{ErrorCode::kInvalidArgument, parts[i] + " is a file and a folder at once"};
  }
  if (at.descriptor() < 0) return failure("opening a folder in " + path_);
  return at;
}

Result<OpenFile> FreshFolder::create(const std::vector<std::string>& parts) const {
  CHECK(!parts.empty(), "a file needs a name");
  const Result<OpenFile> folder = descend(parts, parts.size() - 1);
  if (!folder.ok()) return folder.error();
  OpenFile file(::openat(folder->descriptor(), parts.back().c_str(), kNewFileFlags, kFileMode));
  if (file.descriptor() >= 0) return file;
  if (errno == EEXIST) return Error{ErrorCode::kInvalidArgument, "there are two of this name"};
  return failure("making a file in " + path_);
}

Status FreshFolder::make_folder(const std::vector<std::string>& parts) const {
  const Result<OpenFile> folder = descend(parts, parts.size());
  if (!folder.ok()) return folder.error();
  return Done{};
}

void FreshFolder::clear() const {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(path_, ignored))
    std::filesystem::remove_all(entry.path(), ignored);
}

Result<TemporaryFolder> TemporaryFolder::make() {
  std::error_code error;
  std::string path = (std::filesystem::temp_directory_path(error) / "hermite-XXXXXX").string();
  if (error || mkdtemp(path.data()) == nullptr) return failure("making a temporary folder " + path);
  return TemporaryFolder(path);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

}  // namespace hermite::archive
