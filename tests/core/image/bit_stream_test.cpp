#include "core/image/bit_stream.h"

#include <gtest/gtest.h>

#include <random>

namespace hermite::image {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(BitStream, LaysBitsFromTheLowestOn) {
  BitWriter writer;
  writer.put(0b1, 1);
  writer.put(0b01, 2);
  writer.put_gamma(5);  // two zeros, a one, then 01
  writer.put(0xffffffff, 32);
  EXPECT_EQ(std::move(writer).finish(), (Bytes{0b01100011, 0xff, 0xff, 0xff, 0xff}));
}

TEST(BitStream, GivesBackWhatWasPut) {
  std::mt19937 random(3);
  struct Number {
    std::uint32_t value;
    int count;  // 0: a gamma code
  };
  std::vector<Number> numbers;
  BitWriter writer;
  for (int i = 0; i < 5000; ++i) {
    const int count = static_cast<int>(random() % 33);
    const auto bits = static_cast<std::uint32_t>(
        count == 0 ? 1 + random() % ((1u << (1 + random() % 20)) - 1) : random() >> (32 - count));
    numbers.push_back({bits, count});
    count == 0 ? writer.put_gamma(bits) : writer.put(bits, count);
  }
  const Bytes bytes = std::move(writer).finish();
  BitReader reader(bytes);
  for (const Number& number : numbers)
    ASSERT_EQ(number.count == 0 ? reader.get_gamma() : reader.get(number.count), number.value);
  EXPECT_FALSE(reader.cut());
  EXPECT_TRUE(reader.rest().empty());
  EXPECT_TRUE(reader.padding_is_zero());
}

TEST(BitStream, BehindTheEndItIsCut) {
  const Bytes bytes{0xff};
  BitReader reader(bytes);
  EXPECT_EQ(reader.get(8), 0xffu);
  EXPECT_FALSE(reader.cut());
  EXPECT_EQ(reader.get(3), 0u);
  EXPECT_TRUE(reader.cut());
  BitReader nothing({});
  EXPECT_EQ(nothing.get_gamma(), 0u);
  EXPECT_TRUE(nothing.cut());
}

TEST(BitStream, AGammaCodeThatIsTooLongIsNone) {
  const Bytes zeros(100, 0);
  BitReader reader(zeros);
  EXPECT_EQ(reader.get_gamma(), 0u);
  EXPECT_FALSE(reader.cut());
}

TEST(BitStream, KnowsWhereTheNextByteBeginsAndWhatLiesBefore) {
  const Bytes bytes{0b00000101, 7, 8};
  BitReader reader(bytes);
  EXPECT_EQ(reader.rest().size(), 3u);
  reader.get(1);
  EXPECT_EQ(reader.rest().size(), 2u);
  EXPECT_FALSE(reader.padding_is_zero());
  reader.get(2);
  EXPECT_TRUE(reader.padding_is_zero());
  EXPECT_EQ(reader.rest().front(), 7);
}

}  // namespace
}  // namespace hermite::image
