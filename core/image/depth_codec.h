// Lossless depth: RVL (Wilson 2017: runs of zeros, zigzag differences in 3-bit groups) inside one zstd level 1 frame.
//
// The zstd frame must state its content size, at most kMaxRvlBytesPerPixel bytes a pixel, and is decoded in one pass into a buffer of exactly
// that size. The RVL decoder checks words left, pixels left and group counts. Pure and thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/image/image_codec.h"

namespace hermite {

std::vector<std::uint8_t> encode_depth_rvl_zstd(const DepthImage& depth);

// kCorruptData or kTooLarge, in words. All 16-bit values round-trip.
Result<DepthImage> decode_depth_rvl_zstd(std::span<const std::uint8_t> bytes, ImageSize expected);

}  // namespace hermite
