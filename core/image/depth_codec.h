// Lossless depth: RVL (Wilson 2017: runs of zeros, zigzag differences in 3-bit groups) inside one
// zstd level 1 frame.
//
// RVL here is a sequence of variable-length numbers, each in groups of 3 bits, lowest first, bit 3
// of a group set when another follows. Eight groups make one little-endian 32-bit word, first group
// highest; the last word is padded with zeros. The numbers are, until all pixels are there: count
// of zeros, count of non-zeros, then for each non-zero the zigzag difference to the previous
// non-zero pixel (to 0 at first). The zstd frame carries a checksum when we write it. It must state
// its content size, at most max_rvl_bytes(), and is decoded in one pass into a buffer of exactly
// that size. The RVL decoder checks words left, pixels left and group counts. Pure and thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/image/image_codec.h"

namespace hermite::image {

// The longest RVL of an image of that many pixels, in bytes: about 3 a pixel.
constexpr std::size_t max_rvl_bytes(std::size_t pixel_count) {
  return 3 * pixel_count + pixel_count / 4096 + 16;
}

// `depth` must not be empty and at most kMaxImageEdge_px on a side (CHECK). Deterministic.
std::vector<std::uint8_t> encode_depth_rvl_zstd(const DepthImage& depth);

// kCorruptData or kTooLarge, with a message; kInvalidArgument when `expected` is not 1 to
// kMaxImageEdge_px. All 16-bit values round-trip.
Result<DepthImage> decode_depth_rvl_zstd(std::span<const std::uint8_t> bytes, ImageSize expected);

// RVL by itself, to measure it. `pixels` are zero when decoding begins.
std::vector<std::uint32_t> encode_rvl(std::span<const std::uint16_t> pixels);
Status decode_rvl(std::span<const std::uint32_t> words, std::span<std::uint16_t> pixels);

}  // namespace hermite::image
