// JPEG and PNG, for files and for the wire alike: one decoder each, so that a streamed and a local
// run see the same pixels.
//
// Every decode states the size it expects; any other size, format or bit depth is an error before a
// pixel is allocated, so that no input can make a decoder take more memory than the expected image.
// Functions are pure and thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"

namespace hermite::image {

struct ImageSize {
  int width = 0, height = 0;  // pixels
  bool operator==(const ImageSize&) const = default;
};

// The longest edge that any codec here takes. An image of that size still takes 800 MB: callers
// bound `expected` themselves.
inline constexpr int kMaxImageEdge_px = 16384;

// kInvalidArgument unless both edges are 1 to kMaxImageEdge_px.
Status check_image_size(ImageSize size);

enum class ImageFormat { kJpeg, kPng };

// From the first bytes. kUnsupported when they are neither.
Result<ImageFormat> detect_image_format(std::span<const std::uint8_t> bytes);

// Size from the header alone. kCorruptData when there is none, kTooLarge beyond kMaxImageEdge_px.
Result<ImageSize> read_image_size(std::span<const std::uint8_t> bytes);

// 8-bit RGB. JPEG may be grey or YCbCr, PNG any colour type of 8 bits (alpha is dropped).
// kTooLarge: another size than expected. kCorruptData: cut or damaged (a JPEG that decodes with
// warnings is damaged). kUnsupported: the rest.
Result<ColorImage> decode_color(std::span<const std::uint8_t> bytes, ImageSize expected);

// 16-bit grey PNG, values as stored.
Result<DepthImage> decode_depth_png(std::span<const std::uint8_t> bytes, ImageSize expected);

// Deterministic. kInvalidArgument when the size or quality is out of range.
// JPEG; quality 1 to 100.
enum class JpegColor {
  kHalf,  // 4:2:0
  kFull,  // 4:4:4
};
Result<std::vector<std::uint8_t>> encode_jpeg(const ColorImage& image, int quality,
                                              JpegColor color = JpegColor::kHalf);

// PNG at the fastest compression level; lossless.
Result<std::vector<std::uint8_t>> encode_png(const ColorImage& image);
Result<std::vector<std::uint8_t>> encode_depth_png(const DepthImage& image);

}  // namespace hermite::image
