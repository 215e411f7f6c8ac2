#include "core/image/inflate.h"

#include <gtest/gtest.h>

namespace hermite::image {
namespace {

TEST(Inflate, RoundTripsAndKeepsToTheSize) {
  std::vector<std::uint8_t> bytes(10'000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * i / 100);
  const std::vector<std::uint8_t> packed = deflate_bytes(bytes);
  EXPECT_EQ(*inflate_exactly(packed, bytes.size()), bytes);
  for (const std::size_t other :
       {std::size_t{0}, std::size_t{1}, bytes.size() - 1, bytes.size() + 1})
    EXPECT_EQ(inflate_exactly(packed, other).error().code, ErrorCode::kCorruptData) << other;
  for (std::size_t cut = 0; cut < packed.size(); cut += 7)
    EXPECT_FALSE(inflate_exactly(std::span(packed).first(cut), bytes.size()).ok()) << cut;
  std::vector<std::uint8_t> damaged = packed;
  damaged.back() ^= 1;  // of the checksum
  EXPECT_FALSE(inflate_exactly(damaged, bytes.size()).ok());
}

}  // namespace
}  // namespace hermite::image
