// Depth as ranks. Input: a byte for the path, a byte for the size, data.
//
// The checksum comes after everything else was decoded, so that bytes with a wrong one get as deep
// as good ones.
#include "core/image/depth_ranks.h"

namespace {

using namespace hermite;

void round_trip(const DepthImage& depth) {
  const std::vector<std::uint8_t> bytes = image::encode_depth_ranks(depth);
  CHECK(bytes.size() <= image::max_depth_ranks_bytes(depth.pixels.size()),
        "depth takes more bytes than its limit");
  const Result<DepthImage> again = image::decode_depth_ranks(bytes, {depth.width, depth.height});
  CHECK(again.ok() && *again == depth, "depth does not round-trip");
}

void decode(std::span<const std::uint8_t> bytes, image::ImageSize size) {
  const Result<DepthImage> depth = image::decode_depth_ranks(bytes, size);
  if (!depth.ok()) {
    CHECK(!depth.error().message.empty(), "an error without words");
    return;
  }
  CHECK(depth->width == size.width && depth->height == size.height,
        "decoded another size than asked for");
  round_trip(*depth);
}

void encode(std::span<const std::uint8_t> pixels, int width) {
  DepthImage depth(width, static_cast<int>(pixels.size() / 2) / width);
  if (depth.pixels.empty()) return;
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    depth.pixels[i] = static_cast<std::uint16_t>(pixels[2 * i] | pixels[2 * i + 1] << 8);
  round_trip(depth);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::span<const std::uint8_t> bytes(data + 2, size - 2);
  const image::ImageSize expected{1 + data[1] % 16, 1 + data[1] / 16};
  if (data[0] % 2 == 0) {
    decode(bytes, expected);
  } else {
    encode(bytes, expected.width);
  }
  return 0;
}
