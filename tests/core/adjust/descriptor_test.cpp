#include "core/adjust/descriptor.h"

#include <gtest/gtest.h>

#include <bit>

#include "tests/core/adjust/point_world.h"

namespace hermite::adjust {
namespace {

TEST(Hamming, CountsTheBitsThatDiffer) {
  const Descriptor none{}, all{~0ull, ~0ull, ~0ull, ~0ull}, one{0, 0, 1ull << 63, 0};
  EXPECT_EQ(hamming(none, none), 0);
  EXPECT_EQ(hamming(none, one), 1);
  EXPECT_EQ(hamming(one, none), 1);
  EXPECT_EQ(hamming(all, one), 255);
  EXPECT_EQ(hamming(all, none), kDescriptorBits);
}

TEST(Hamming, AgreesWithTheLibrary) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    const Descriptor a = test::random_descriptor(random), b = test::with_flipped_bits(a, i, random);
    int bits = 0;
    for (std::size_t word = 0; word < 4; ++word) bits += std::popcount(a[word] ^ b[word]);
    EXPECT_EQ(hamming(a, b), bits);
  }
}

TEST(Medoid, IsTheOneInTheMiddle) {
  std::mt19937_64 random(1);
  const Descriptor middle = test::random_descriptor(random),
                   stranger = test::random_descriptor(random);
  std::vector<Descriptor> descriptors{stranger};
  for (int i = 0; i < 5; ++i) descriptors.push_back(test::with_flipped_bits(middle, 30, random));
  descriptors.push_back(middle);
  EXPECT_EQ(medoid(descriptors), 6u);
}

TEST(Medoid, OfEqualsIsTheFirst) {
  EXPECT_EQ(medoid({Descriptor{5}}), 0u);
  EXPECT_EQ(medoid({Descriptor{5}, Descriptor{9}}), 0u);
  EXPECT_EQ(medoid({Descriptor{5}, Descriptor{5}, Descriptor{5}}), 0u);
}

}  // namespace
}  // namespace hermite::adjust
