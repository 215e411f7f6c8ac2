#include "core/image/nibble_depth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/core/image/nibble_bytes.h"

namespace hermite::image {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;
using Values = std::vector<std::uint16_t>;

std::string message_of(const Result<DepthImage>& result) {
  return result.ok() ? "decoded" : result.error().message;
}

// Steps of every kind: none, small, medium, large, long runs, up and down.
Values varied_values(std::size_t count) {
  Values values;
  std::uint64_t state = 11;
  std::uint16_t value = 800;
  while (values.size() < count) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const auto kind = (state >> 60) % 5;
    const auto random = static_cast<int>(state >> 33 & 0x7fff);
    if (kind == 0) value = static_cast<std::uint16_t>(random);
    if (kind == 1)
      value = static_cast<std::uint16_t>(std::clamp(value + random % 127 - 63, 0, 0x7fff));
    if (kind == 2)
      value = static_cast<std::uint16_t>(std::clamp(value + random % 13 - 6, 0, 0x7fff));
    if (kind == 3) values.insert(values.end(), static_cast<std::size_t>(random % 90), value);
    values.push_back(value);
  }
  values.resize(count);
  return values;
}

TEST(NibbleDepth, EveryCodeIsUnderstood) {
  // 1000; differences -6 and 6; two pairs of none; half a byte and a medium step; a long value; a
  // medium step alone; the end.
  const Bytes bytes{0xe8, 0x03, 0x0c, 0xe2, 0x7f, 0xff, 0xff, 0x12, 0x34, 0xff, 0x81, 0x5d};
  const auto depth = decode_depth_nibbles(bytes, {6, 2});
  ASSERT_TRUE(depth.ok()) << depth.error().message;
  EXPECT_EQ(depth->pixels, (Values{1000, 1006, 1000, 1000, 1000, 1000, 1000, 999, 936, 0x1234,
                                   0x1234 + 63, 0x1234 + 64}));
}

TEST(NibbleDepth, BothFormsReadBackBitForBit) {
  for (const int width : {1, 7, 64, 321}) {
    const ImageSize size{width, 48};
    const Values values = varied_values(static_cast<std::size_t>(width) * 48);
    const auto plain = decode_depth_nibbles(test::nibble_bytes(values), size);
    ASSERT_TRUE(plain.ok()) << plain.error().message;
    EXPECT_EQ(plain->pixels, values);
    const auto with_table =
        decode_depth_nibbles_with_table(test::nibble_bytes_with_table(values), size);
    ASSERT_TRUE(with_table.ok()) << with_table.error().message;
    EXPECT_EQ(with_table->pixels, values);
    EXPECT_EQ(with_table->width, width);
  }
}

TEST(NibbleDepth, DamageIsSaidInAMessage) {
  EXPECT_THAT(message_of(decode_depth_nibbles({}, {2, 2})), HasSubstr("before the first pixel"));
  EXPECT_THAT(message_of(decode_depth_nibbles(Bytes{1, 0, 0x66}, {2, 2})),
              HasSubstr("has 3 pixels of 4"));
  EXPECT_THAT(message_of(decode_depth_nibbles(Bytes{1, 0, 0x66, 0xe1}, {2, 2})),
              HasSubstr("more pixels than the image has at byte 4 of 4"));
  EXPECT_THAT(message_of(decode_depth_nibbles(Bytes{1, 0, 0xff}, {2, 2})), HasSubstr("cut"));
  EXPECT_THAT(message_of(decode_depth_nibbles(Bytes{1, 0, 0xff, 0x12}, {2, 2})), HasSubstr("cut"));
  EXPECT_THAT(message_of(decode_depth_nibbles(Bytes{1, 0, 0x6f}, {2, 2})), HasSubstr("cut"));
  EXPECT_EQ(decode_depth_nibbles(Bytes{1, 0}, {0, 2}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(message_of(decode_depth_nibbles_with_table(Bytes{0, 0, 0, 0}, {1, 1})),
              HasSubstr("table of values is empty"));
  EXPECT_THAT(message_of(decode_depth_nibbles_with_table(Bytes{2, 0, 7, 0, 8}, {1, 1})),
              HasSubstr("table of 2 values is cut"));
  EXPECT_THAT(message_of(decode_depth_nibbles_with_table(Bytes{2, 0, 7, 0, 8, 0, 2, 0}, {1, 1})),
              HasSubstr("outside the table"));
  EXPECT_THAT(
      message_of(decode_depth_nibbles_with_table(Bytes{2, 0, 7, 0, 8, 0, 1, 0, 0x5d}, {2, 1})),
      HasSubstr("outside the table"));
}

TEST(NibbleDepth, AnyBytesGiveAnErrorOrAnImage) {
  const Bytes whole = test::nibble_bytes_with_table(varied_values(64 * 48));
  std::uint64_t state = 3;
  for (int i = 0; i < 2000; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    Bytes bytes = whole;
    bytes[(state >> 16) % bytes.size()] ^= static_cast<std::uint8_t>(1 << (state >> 61));
    if (i % 3 == 0) bytes.resize((state >> 20) % bytes.size());
    for (const auto& depth :
         {decode_depth_nibbles(bytes, {64, 48}), decode_depth_nibbles_with_table(bytes, {64, 48})})
      EXPECT_TRUE(depth.ok() ? depth->pixels.size() == 64 * 48
                             : depth.error().code == ErrorCode::kCorruptData);
  }
}

}  // namespace
}  // namespace hermite::image
