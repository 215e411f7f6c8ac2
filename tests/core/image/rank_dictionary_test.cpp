#include "core/image/rank_dictionary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::image {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;
using Values = std::vector<std::uint16_t>;

Bytes written(const RankDictionary& dictionary) {
  BitWriter header;
  write_rank_dictionary(dictionary, header);
  return std::move(header).finish();
}

TEST(RankDictionary, HoldsTheValuesOfASparseSensor) {
  Values pixels;
  for (int i = 0; i < 10000; ++i) pixels.push_back(static_cast<std::uint16_t>(i % 50 * 20));
  const RankDictionary dictionary = find_rank_dictionary(pixels);
  ASSERT_EQ(dictionary.size(), 50u);
  EXPECT_EQ(dictionary[0], 0);
  EXPECT_EQ(dictionary[49], 980);
  EXPECT_EQ(highest_rank(dictionary), 49);
  const Values rank_of = ranks_by_value(dictionary);
  EXPECT_EQ(rank_of[0], 0);
  EXPECT_EQ(rank_of[20], 1);
  EXPECT_EQ(rank_of[980], 49);
}

TEST(RankDictionary, DenseValuesAreTheirOwnRanks) {
  Values pixels;
  for (int i = 0; i < 10000; ++i) pixels.push_back(static_cast<std::uint16_t>(1000 + i % 2000));
  const RankDictionary dictionary = find_rank_dictionary(pixels);
  EXPECT_TRUE(dictionary.empty());
  EXPECT_EQ(highest_rank(dictionary), 65535);
  EXPECT_EQ(ranks_by_value(dictionary)[1234], 1234);
}

TEST(RankDictionary, WithoutAValidPixelHoldsInvalidOnly) {
  const RankDictionary dictionary = find_rank_dictionary(Values(100, 0));
  EXPECT_EQ(dictionary, RankDictionary{0});
  EXPECT_EQ(highest_rank(dictionary), 0);
}

TEST(RankDictionary, ComesBackAsItWasWritten) {
  RankDictionary every_value(65536);
  for (std::size_t i = 0; i < every_value.size(); ++i)
    every_value[i] = static_cast<std::uint16_t>(i);
  for (const RankDictionary& dictionary :
       {RankDictionary{}, RankDictionary{0}, RankDictionary{0, 1, 2, 900, 65535}, every_value}) {
    const Bytes bytes = written(dictionary);
    BitReader header(bytes);
    const Result<RankDictionary> back = read_rank_dictionary(header);
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(*back, dictionary);
    EXPECT_FALSE(header.cut());
  }
}

TEST(RankDictionary, RefusesWhatIsNone) {
  const auto refusal = [](const Bytes& bytes) {
    BitReader header(bytes);
    const Result<RankDictionary> dictionary = read_rank_dictionary(header);
    return dictionary.ok() ? "read" : dictionary.error().message;
  };
  EXPECT_THAT(refusal({1}), HasSubstr("no valid size"));
  EXPECT_THAT(refusal(Bytes{0x01, 0, 0, 0}), HasSubstr("no valid size"));
  BitWriter beyond;
  beyond.put(1, 1);
  beyond.put_gamma(3);
  beyond.put_gamma(65535);
  beyond.put_gamma(1);
  EXPECT_THAT(refusal(std::move(beyond).finish()),
              HasSubstr("value 2 of 2 in the dictionary is no depth"));
  Bytes cut = written({0, 5, 900, 2000});
  cut.resize(cut.size() / 2);
  EXPECT_THAT(refusal(cut), HasSubstr("in the dictionary is no depth"));
}

}  // namespace
}  // namespace hermite::image
