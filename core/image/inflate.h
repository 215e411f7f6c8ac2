// zlib streams whose size is known beforehand: depth in .klg and .sens files. Pure and thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"

namespace hermite::image {

// Exactly `byte_count` bytes, in one pass into a buffer of that size. kCorruptData: damaged, cut,
// or another size.
Result<std::vector<std::uint8_t>> inflate_exactly(std::span<const std::uint8_t> bytes,
                                                  std::size_t byte_count);

// At the fastest level. Deterministic.
std::vector<std::uint8_t> deflate_bytes(std::span<const std::uint8_t> bytes);

}  // namespace hermite::image
