#include "core/image/inflate.h"

#include <fmt/core.h>
#include <zlib.h>

#include <string>

namespace hermite::image {

Result<std::vector<std::uint8_t>> inflate_exactly(std::span<const std::uint8_t> bytes,
                                                  std::size_t byte_count) {
  std::vector<std::uint8_t> inflated(byte_count);
  uLongf inflated_bytes = byte_count;
  uLong used_bytes = bytes.size();
  const int status = uncompress2(inflated.data(), &inflated_bytes, bytes.data(), &used_bytes);
  const std::string expected = ", expected are " + std::to_string(byte_count);
  if (status == Z_BUF_ERROR && inflated_bytes == byte_count)
    return Error{ErrorCode::kCorruptData, "zlib: more bytes than that" + expected};
  if (status != Z_OK)
    return Error{ErrorCode::kCorruptData,
                 fmt::format("zlib: damaged or cut after {} bytes{}", inflated_bytes, expected)};
  if (inflated_bytes != byte_count)
    return Error{ErrorCode::kCorruptData,
                 fmt::format("zlib: {} bytes{}", inflated_bytes, expected)};
  return inflated;
}

std::vector<std::uint8_t> deflate_bytes(std::span<const std::uint8_t> bytes) {
  uLongf deflated_bytes = compressBound(bytes.size());
  std::vector<std::uint8_t> deflated(deflated_bytes);
  CHECK(
      compress2(deflated.data(), &deflated_bytes, bytes.data(), bytes.size(), Z_BEST_SPEED) == Z_OK,
      "the bound was too small");
  deflated.resize(deflated_bytes);
  return deflated;
}

}  // namespace hermite::image
