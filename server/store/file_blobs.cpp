#include "server/store/file_blobs.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "core/base/check.h"
#include "core/base/sync_path.h"
#include "core/output/ply.h"
#include "server/store/owned_descriptor.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

namespace fs = std::filesystem;

Error io_error(const std::string& what, int error) {
  return {ErrorCode::kIo, what + ": " + std::strerror(error)};
}

// For reading; refuses symbolic links, since blobs are never links.
int open_blob(const std::string& path) {
  return open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
}

Error cannot_open(const std::string& path, int error) {
  return error == ENOENT || error == ENOTDIR || error == ELOOP
             ? Error{ErrorCode::kNotFound, "there is no " + path}
             : io_error("opening " + path, error);
}

// Returns the status of a regular file.
Result<struct stat> status_of(const OwnedDescriptor& file, const std::string& path) {
  struct stat status {};
  if (fstat(file.descriptor, &status) != 0) return io_error("reading " + path, errno);
  if (!S_ISREG(status.st_mode)) return Error{ErrorCode::kNotFound, path + " is no file"};
  return status;
}

Result<std::uint64_t> size_of(const OwnedDescriptor& file, const std::string& path) {
  const Result<struct stat> status = status_of(file, path);
  if (!status.ok()) return status.error();
  return static_cast<std::uint64_t>(status->st_size);
}

// The name of a new folder is stored in its parent, so the parent has to be synced.
Status make_folder(const std::string& folder, const std::string& parent) {
  if (mkdir(folder.c_str(), 0700) != 0)
    return errno == EEXIST ? Status(Done{}) : Status(io_error("creating " + folder, errno));
  return sync_path(parent);
}

}  // namespace

std::string FileBlobs::folder_of(const std::string& scan_id) const {
  CHECK(is_scan_id(scan_id), "a path from something that is no scan id");
  return folder_ + "/" + scan_id;
}

std::string FileBlobs::path_of(const std::string& scan_id, const std::string& name) const {
  CHECK(is_blob_name(name), "a path from something that is no name of a blob");
  return folder_of(scan_id) + "/" + name;
}

Status FileBlobs::put(const std::string& scan_id, const std::string& name,
                      const std::string& bytes) {
  const std::string path = path_of(scan_id, name);
  if (Status status = make_folder(folder_of(scan_id), folder_); !status.ok()) return status;
  return output::write_file_atomically(path, bytes);
}

Result<std::string> FileBlobs::read(const std::string& scan_id, const std::string& name,
                                    std::uint64_t offset, std::size_t max_bytes) {
  const std::string path = path_of(scan_id, name);
  const OwnedDescriptor file(open_blob(path));
  if (file.descriptor < 0) return cannot_open(path, errno);
  const Result<std::uint64_t> size_bytes = size_of(file, path);
  if (!size_bytes.ok()) return size_bytes.error();
  if (offset >= *size_bytes) return std::string();
  std::string bytes(
      static_cast<std::size_t>(std::min<std::uint64_t>(max_bytes, *size_bytes - offset)), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = pread(file.descriptor, bytes.data() + done, bytes.size() - done,
                                static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return io_error("reading " + path, errno);
    if (count == 0) return Error{ErrorCode::kIo, path + " has become shorter"};
    done += static_cast<std::size_t>(count);
  }
  return bytes;
}

Result<std::uint64_t> FileBlobs::size_bytes(const std::string& scan_id, const std::string& name) {
  const std::string path = path_of(scan_id, name);
  const OwnedDescriptor file(open_blob(path));
  if (file.descriptor < 0) return cannot_open(path, errno);
  return size_of(file, path);
}

// Every put creates a new file, which differs from the old one whatever the clock says.
Result<std::string> FileBlobs::version(const std::string& scan_id, const std::string& name) {
  const std::string path = path_of(scan_id, name);
  const OwnedDescriptor file(open_blob(path));
  if (file.descriptor < 0) return cannot_open(path, errno);
  const Result<struct stat> status = status_of(file, path);
  if (!status.ok()) return status.error();
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%llx-%llx-%llx-%lx",
                static_cast<unsigned long long>(status->st_size),
                static_cast<unsigned long long>(status->st_ino),
                static_cast<unsigned long long>(status->st_mtim.tv_sec),
                static_cast<unsigned long>(status->st_mtim.tv_nsec));
  return std::string(text.data());
}

Result<std::vector<BlobInfo>> FileBlobs::list(const std::string& scan_id) {
  const std::string folder = folder_of(scan_id);
  std::vector<BlobInfo> found;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  if (error == std::errc::no_such_file_or_directory) return found;
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename();
    std::error_code gone;  // set if the file was removed after it was listed
    if (!is_blob_name(name) || !fs::is_regular_file(entry->symlink_status(gone))) continue;
    const std::uintmax_t size_bytes = entry->file_size(gone);
    if (!gone) found.push_back({name, size_bytes});
  }
  if (error) return Error{ErrorCode::kIo, fmt::format("reading {}: {}", folder, error.message())};
  std::sort(found.begin(), found.end(),
            [](const BlobInfo& a, const BlobInfo& b) { return a.name < b.name; });
  return found;
}

Status FileBlobs::remove(const std::string& scan_id) {
  const Result<std::vector<BlobInfo>> blobs = list(scan_id);
  if (!blobs.ok()) return blobs.error();
  for (const BlobInfo& blob : *blobs)
    if (Status status = remove(scan_id, blob.name); !status.ok()) return status;
  return Done{};
}

Status FileBlobs::remove(const std::string& scan_id, const std::string& name) {
  const std::string path = path_of(scan_id, name);
  if (unlink(path.c_str()) != 0 && errno != ENOENT) return io_error("removing " + path, errno);
  return Done{};
}

}  // namespace hermite::server
