#include "server/capture/frame_pairing.h"

#include <gtest/gtest.h>

namespace hermite::client::frame_pairing_test {
namespace {

constexpr double kGap_s = 0.020;

DepthImage depth(std::uint16_t value) {
  DepthImage image(1, 1);
  image.pixels[0] = value;
  return image;
}

ColorImage color(std::uint8_t value) {
  ColorImage image(1, 1);
  image.pixels[0].r = value;
  return image;
}

TEST(FramePairing, GivesEachDepthImageTheNearestColourAndItsOwnTime) {
  FramePairing pairing(kGap_s);
  pairing.add_color(0.000, color(1));
  pairing.add_depth(0.010, depth(10));
  EXPECT_FALSE(pairing.take()) << "a nearer colour may come";
  pairing.add_color(0.012, color(2));
  const auto frame = pairing.take();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->timestamp_s, 0.010);
  EXPECT_EQ(frame->depth.pixels[0], 10);
  EXPECT_EQ(frame->color.pixels[0].r, 2);
  EXPECT_FALSE(pairing.take());
  EXPECT_EQ(pairing.unpaired_depth_count(), 0u);
}

TEST(FramePairing, AnEarlierColourIsTakenWhereItIsNearer) {
  FramePairing pairing(kGap_s);
  pairing.add_color(0.009, color(1));
  pairing.add_depth(0.010, depth(10));
  pairing.add_color(0.033, color(2));
  EXPECT_EQ(pairing.take()->color.pixels[0].r, 1);
  pairing.add_depth(0.040, depth(11));
  pairing.add_color(0.066, color(3));
  EXPECT_EQ(pairing.take()->color.pixels[0].r, 2) << "what was not used stays for the next";
}

TEST(FramePairing, NoColourIsUsedTwice) {
  FramePairing pairing(kGap_s);
  pairing.add_depth(0.000, depth(10));
  pairing.add_color(0.001, color(1));
  pairing.add_depth(0.005, depth(11));
  EXPECT_TRUE(pairing.take());
  pairing.add_color(0.050, color(2));
  EXPECT_FALSE(pairing.take());
  EXPECT_EQ(pairing.unpaired_depth_count(), 1u);
}

TEST(FramePairing, ADepthImageWithoutColourIsLeftOutAndCounted) {
  FramePairing pairing(kGap_s);
  for (int k = 0; k < 3; ++k)
    pairing.add_depth(0.033 * k, depth(static_cast<std::uint16_t>(k + 1)));
  EXPECT_FALSE(pairing.take());
  EXPECT_EQ(pairing.unpaired_depth_count(), 2u) << "the last may still get one";
  pairing.add_color(0.066, color(1));
  EXPECT_EQ(pairing.take()->depth.pixels[0], 3);
}

TEST(FramePairing, ImagesThatGoBackInTimeAreDropped) {
  FramePairing pairing(kGap_s);
  pairing.add_depth(1.0, depth(1));
  pairing.add_color(1.0, color(1));
  EXPECT_TRUE(pairing.take());
  pairing.add_depth(0.5, depth(2));
  pairing.add_color(0.5, color(2));
  pairing.add_color(1.0, color(2));
  EXPECT_FALSE(pairing.take());
}

TEST(FramePairing, HoldsAFewImagesHoweverManyComeAlone) {
  FramePairing pairing(1e9);  // they would wait for ever
  for (int k = 0; k < 100; ++k) pairing.add_depth(k, depth(static_cast<std::uint16_t>(k)));
  EXPECT_EQ(pairing.unpaired_depth_count(), 100 - FramePairing::kMaxWaiting);
  pairing.add_color(1000, color(1));
  EXPECT_EQ(pairing.take()->depth.pixels[0], 96);
}

}  // namespace
}  // namespace hermite::client::frame_pairing_test
