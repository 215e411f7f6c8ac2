// Lossless depth by ranks: every depth becomes its rank among the values of its frame, is predicted
// from its neighbours, and the error is entropy coded. A structured light sensor has only some
// hundred depths (its disparities), so that neighbours differ by 0 or 1 ranks; where the values are
// dense (time of flight) the ranks are the values themselves. Each frame stands alone.
//
// Bytes, numbers low byte first:
//   checksum       32 bits, of the pixels
//   header         bits, lowest of a byte first, the last byte filled with zeros; gamma codes as in
//                  bit_stream.h
//     dictionary   1 bit. 1: gamma(count + 1), then for each value, ascending, gamma(value - the
//                  one before, 0 at first).
//                  0: the ranks are the values.
//     frequencies  for each context: 1 bit. 0: it is not used. 1: for each symbol in use,
//                  ascending, gamma(symbols skipped + 1) and gamma(frequency), until the
//                  frequencies sum up to kFrequencySum.
//   words          rANS (rans.h), to the end
//
// The image falls into two bands, the upper one a row higher if the rows are odd; each has its
// lane, and pixels are decoded in turn, one of each band, row by row. A pixel's neighbours are the
// four already decoded ones around it: west, north-west, north, north-east; beyond the band they
// are invalid. They give the prediction and the context. Symbol 0 is an invalid pixel; the others
// stand for the zigzag number z of rank - prediction: 1 + z below 32, else by z's highest bit and
// the two below it, with the remaining bits behind.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/image/image_codec.h"

namespace hermite::image {

// The most bytes that an image of that many pixels can take. Noise takes little more than 2 a
// pixel.
constexpr std::size_t max_depth_ranks_bytes(std::size_t pixel_count) {
  return 4 * pixel_count + 32768;
}

// `depth` must not be empty and at most kMaxImageEdge_px on a side (CHECK). Deterministic, the same
// bytes on every machine.
std::vector<std::uint8_t> encode_depth_ranks(const DepthImage& depth);

// kCorruptData or kTooLarge, with a message; kInvalidArgument when `expected` is not 1 to
// kMaxImageEdge_px. Takes the time and memory of the expected image whatever the bytes are, and
// never gives pixels with another checksum.
Result<DepthImage> decode_depth_ranks(std::span<const std::uint8_t> bytes, ImageSize expected);

}  // namespace hermite::image
