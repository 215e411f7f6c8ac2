// Bytes of our own in one zstd frame. Pure and thread-safe.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace hermite::image {

// At the fastest level, with a checksum. Deterministic for one version of the library.
std::string compress_bytes(std::string_view bytes);

// Exactly one whole frame that states its content's size. kCorruptData: damaged or cut. kTooLarge:
// it states more than `max_bytes`. Allocates what it states: a caller that cannot trust that looks
// at a checksum of its own first.
Result<std::string> decompress_bytes(std::string_view frame, std::size_t max_bytes);

}  // namespace hermite::image
