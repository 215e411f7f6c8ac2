// Recordings that come packed: .tar, .tar.gz, .tar.zst and .zip, by libarchive.
//
// What is in an archive is a stranger's. Regular files and folders are unpacked; links, devices,
// FIFOs, sparse and encrypted files, archives inside the archive and names that entry_name.h
// refuses are errors that name the entry. Limits count what was really written, not what a header
// promises. Nothing is written outside the folder, and after an error nothing is left in it.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>

#include "core/base/result.h"

namespace hermite::archive {

struct UnpackLimits {
  std::uint64_t output_bytes = std::uint64_t{64} << 30;
  std::int64_t entry_count = 200'000;  // colour and depth of 55 minutes at 30 Hz
  // Ratio of unpacked to packed bytes. Images are compressed already, depth as raw numbers shrinks
  // 10 times.
  std::uint64_t ratio = 200;
  std::uint64_t ratio_free_bytes = std::uint64_t{64} << 20;  // up to this size any ratio is allowed
  // What there is room for now on the disk that the folder is on, and what there could ever be room
  // for.
  std::uint64_t room_bytes = std::numeric_limits<std::uint64_t>::max(),
                capacity_bytes = std::numeric_limits<std::uint64_t>::max();
  // The same in inodes: for the room each entry counts for its file and all folders in its name,
  // for the capacity files are counted.
  std::uint64_t room_inodes = std::numeric_limits<std::uint64_t>::max(),
                capacity_inodes = std::numeric_limits<std::uint64_t>::max();
  // Called after some files or megabytes: returns whether the disk still has the free space that
  // others need. Empty: nobody else writes.
  std::function<bool()> has_room_left;
};

// Called now and then with the number of bytes that have been unpacked; false ends the unpacking
// with kIo. Must not block.
using UnpackWatch = std::function<bool(std::uint64_t output_bytes)>;

struct UnpackSummary {
  std::string kind;  // "tar.zst"
  std::int64_t file_count = 0;
  std::uint64_t output_bytes = 0;
};

// Returns whether a file is an archive, by its first bytes: a zip, or a tar as it is or in gzip or
// zstd (whatever is inside these is found out on unpacking). False for what cannot be read.
bool is_archive(const std::string& path);

// Unpacks into `folder`, which is made if it does not exist and must be empty. An archive beyond
// room_bytes is read to its end without being written, so that one with an error of its own never
// gets kBusy.
// kNotFound, kIo; kCorruptData: cut or damaged; kTooLarge: a limit that will be the same tomorrow;
// kBusy: nothing is wrong with it, but the disk has no room for it now; kUnsupported: no such
// archive; kInvalidArgument: an entry that is refused, or a folder that is not empty. Memory: under
// 256 MiB, of which zstd may ask for 128. Thread-safe for different folders.
Result<UnpackSummary> unpack_archive(const std::string& path, const std::string& folder,
                                     const UnpackLimits& limits = {},
                                     const UnpackWatch& watch = {});

}  // namespace hermite::archive
