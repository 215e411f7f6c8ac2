// What the file system of a folder has room for. Paths must exist. Thread-safe; errors are kIo,
// with a message.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite::server {

struct Inodes {
  // Both the largest number where the file system has no fixed number of them.
  std::uint64_t free = 0, all = 0;
};
// For free_bytes(). Most files of scans have more: segments of frame logs, results.
inline constexpr std::uint64_t kBytesPerInode = 1'000'000;

// Returns the inodes of the file system: one for each file and folder.
Result<Inodes> disk_inodes(const std::string& path);

// Returns the bytes available to this user in the file system; no more than kBytesPerInode for each
// free inode, so that what keeps bytes free for others also keeps inodes free for them.
Result<std::uint64_t> free_bytes(const std::string& path);

// Returns the bytes that would be available to this user if nothing were stored in the file system.
Result<std::uint64_t> disk_capacity_bytes(const std::string& path);

// Creates a file named `probe` in the folder and removes it. kIo: the disk is not writable, for
// example because it has become read-only.
Status check_takes_files(const std::string& folder);

}  // namespace hermite::server
