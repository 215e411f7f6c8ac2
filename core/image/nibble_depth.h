// Depth as OpenNI's recordings compress it ("16zP", "16zT"): lossless differences of neighbours,
// most of them in half a byte. Only read.
//
// The image as one row of 16-bit values. The first is stored as it is, little endian; each after it
// as the one before minus a difference:
//   0xHL        differences H - 6 and L - 6, first H: 0 to 12 stand for -6 to 6. L = 13: the image
//               ended after H. L = 15: a long value follows
//   0xE0 - 0xEF the value before again, two times the low half
//   0xFF        a long value follows: one byte of 128 or more, the difference plus 192; else the
//               value itself in two bytes, high byte first
// "16zT" has a table before that, a 16-bit number of values and these, and then codes places in the
// table. Pure and thread-safe.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/image/image_codec.h"

namespace hermite::image {

// kCorruptData when the bytes end early, hold fewer or more pixels than `expected`, or name a place
// outside the table; kInvalidArgument for an impossible size.
Result<DepthImage> decode_depth_nibbles(std::span<const std::uint8_t> bytes, ImageSize expected);
Result<DepthImage> decode_depth_nibbles_with_table(std::span<const std::uint8_t> bytes,
                                                   ImageSize expected);

}  // namespace hermite::image
