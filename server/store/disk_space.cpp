#include "server/store/disk_space.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <system_error>

#include "server/store/errno_error.h"
#include "server/store/owned_descriptor.h"

namespace hermite::server {

Result<Inodes> disk_inodes(const std::string& path) {
  struct statvfs status {};
  if (statvfs(path.c_str(), &status) != 0) return errno_error("asking for the inodes of " + path);
  constexpr std::uint64_t kMany = std::numeric_limits<std::uint64_t>::max();
  if (status.f_files == 0) return Inodes{kMany, kMany};
  return Inodes{status.f_favail, status.f_files};
}

Result<std::uint64_t> free_bytes(const std::string& path) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(path, error);
  if (error)
    return Error{ErrorCode::kIo,
                 fmt::format("asking for the free space of {}: {}", path, error.message())};
  const Result<Inodes> inodes = disk_inodes(path);
  if (!inodes.ok()) return inodes.error();
  const bool has_many = inodes->free > space.available / kBytesPerInode;
  return has_many ? static_cast<std::uint64_t>(space.available) : inodes->free * kBytesPerInode;
}

Result<std::uint64_t> disk_capacity_bytes(const std::string& path) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(path, error);
  if (error)
    return Error{ErrorCode::kIo,
                 fmt::format("asking for the size of the disk of {}: {}", path, error.message())};
  // Blocks reserved for root are not available.
  return static_cast<std::uint64_t>(space.capacity - (space.free - space.available));
}

Status check_takes_files(const std::string& folder) {
  const std::string path = folder + "/probe";
  const OwnedDescriptor file(open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (file.descriptor < 0 || unlink(path.c_str()) != 0)
    return errno_error("making a file in " + folder);
  return Done{};
}

}  // namespace hermite::server
