// Checksums of the parts of an object, so that a part can be read and checked alone: S3 knows one
// checksum of the whole. They are kept with the object as metadata (x-amz-meta-...), which may have
// two kilobytes in all. Pure functions.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace hermite::server {

// The bytes in a block, at least; an object has at most kMaxBlocks, so those of a large one are
// larger.
inline constexpr std::uint64_t kLeastBlock_bytes = 4 * 1024 * 1024;
inline constexpr std::uint64_t kMaxBlocks = 96;

struct BlockSums {
  std::uint64_t size_bytes = 0;   // of the object
  std::uint64_t block_bytes = 0;  // of each block but the last, which may be shorter
  std::vector<std::string> sums;  // the first 64 bits of each block's SHA-256, as 16 hex digits
  bool operator==(const BlockSums&) const = default;
};

BlockSums block_sums(std::string_view bytes);

// Whether `block` is the block with this number.
bool is_block(const BlockSums& sums, std::size_t number, std::string_view block);

using S3Headers = std::vector<std::pair<std::string, std::string>>;
S3Headers metadata_of(const BlockSums& sums);

// Reads the sums of an object of this size from the headers of an answer, with names in lower case.
// kIo, with a message: they are missing or do not fit, so the object was not stored by Hermite.
Result<BlockSums> parse_metadata(const std::map<std::string, std::string>& headers,
                                 std::uint64_t size_bytes);

}  // namespace hermite::server
