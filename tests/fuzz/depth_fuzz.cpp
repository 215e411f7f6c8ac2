// Depth as RVL in zstd. Input: a byte for the path, a byte for the size, data.
//
// Random bytes hardly ever make a valid zstd frame, so one path packs them itself and the RVL
// decoder gets its share.
#include <zstd.h>

#include "core/image/depth_codec.h"

namespace {

using namespace hermite;
using Bytes = std::vector<std::uint8_t>;

// What decodes must survive another round trip.
void decode(std::span<const std::uint8_t> bytes, image::ImageSize size) {
  const Result<DepthImage> depth = image::decode_depth_rvl_zstd(bytes, size);
  if (!depth.ok()) return;
  CHECK(depth->width == size.width && depth->height == size.height,
        "decoded another size than asked for");
  const Result<DepthImage> again =
      image::decode_depth_rvl_zstd(image::encode_depth_rvl_zstd(*depth), size);
  CHECK(again.ok() && *again == *depth, "depth does not round-trip");
}

Bytes packed(std::span<const std::uint8_t> words) {
  Bytes bytes(ZSTD_compressBound(words.size()));
  bytes.resize(ZSTD_compress(bytes.data(), bytes.size(), words.data(), words.size(), 1));
  return bytes;
}

void round_trip(std::span<const std::uint8_t> pixels, int width) {
  DepthImage depth(width, static_cast<int>(pixels.size() / 2) / width);
  if (depth.pixels.empty()) return;
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    depth.pixels[i] = static_cast<std::uint16_t>(pixels[2 * i] | pixels[2 * i + 1] << 8);
  const Result<DepthImage> again = image::decode_depth_rvl_zstd(image::encode_depth_rvl_zstd(depth),
                                                                {depth.width, depth.height});
  CHECK(again.ok() && *again == depth, "depth does not round-trip");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::span<const std::uint8_t> bytes(data + 2, size - 2);
  const image::ImageSize expected{1 + data[1] % 16, 1 + data[1] / 16};
  switch (data[0] % 3) {
    case 0: decode(bytes, expected); break;
    case 1: decode(packed(bytes.first(bytes.size() / 4 * 4)), expected); break;
    default: round_trip(bytes, expected.width); break;
  }
  return 0;
}
