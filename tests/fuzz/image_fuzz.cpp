// JPEG and PNG, colour and depth. Input: the bytes of a file.
//
// A PNG with a wrong checksum is refused at once, so the mutator corrects the checksums of what it
// changed.
#include <zlib.h>

#include <algorithm>

#include "core/image/image_codec.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using namespace hermite;

constexpr int kMaxPixels = 128 * 128;
constexpr std::size_t kPngSignature_bytes = 8;
constexpr std::size_t kPngChunkFrame_bytes = 12;  // length, type, checksum

std::uint32_t read_u32(const std::uint8_t* at) {
  return std::uint32_t{at[0]} << 24 | std::uint32_t{at[1]} << 16 | std::uint32_t{at[2]} << 8 |
         std::uint32_t{at[3]};
}

void correct_png_checksums(std::span<std::uint8_t> png) {
  std::size_t at = kPngSignature_bytes;
  while (at + kPngChunkFrame_bytes <= png.size()) {
    const std::size_t length = read_u32(&png[at]);
    if (length > png.size() - at - kPngChunkFrame_bytes) return;
    const auto checksum =
        static_cast<std::uint32_t>(crc32(0, &png[at + 4], static_cast<uInt>(length + 4)));
    for (std::size_t i = 0; i < 4; ++i)
      png[at + 8 + length + i] = static_cast<std::uint8_t>(checksum >> (24 - 8 * i));
    at += length + kPngChunkFrame_bytes;
  }
}

template <class Image>
void check_size(const Result<Image>& image, image::ImageSize size) {
  if (!image.ok()) {
    CHECK(!image.error().message.empty(), "an error without words");
    return;
  }
  CHECK(image->width == size.width && image->height == size.height,
        "decoded another size than asked for");
  CHECK(image->pixels.size() ==
            static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height),
        "decoded other pixels");
}

void decode(std::span<const std::uint8_t> bytes, image::ImageSize size) {
  check_size(image::decode_color(bytes, size), size);
  const Result<DepthImage> depth = image::decode_depth_png(bytes, size);
  check_size(depth, size);
  if (!depth.ok()) return;
  const Result<std::vector<std::uint8_t>> encoded = image::encode_depth_png(*depth);
  CHECK(encoded.ok(), "decoded depth cannot be encoded");
  const Result<DepthImage> again = image::decode_depth_png(*encoded, size);
  CHECK(again.ok() && *again == *depth, "depth does not round-trip");
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  const std::size_t new_size = LLVMFuzzerMutate(data, size, max_size);
  const Result<image::ImageFormat> format = image::detect_image_format({data, new_size});
  if (format.ok() && *format == image::ImageFormat::kPng && seed % 8 != 0)
    correct_png_checksums({data, new_size});
  return new_size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  const Result<image::ImageSize> stated = image::read_image_size(bytes);
  decode(bytes, {16, 12});  // whatever the file says it is
  if (stated.ok() && stated->width * stated->height <= kMaxPixels) decode(bytes, *stated);
  return 0;
}
