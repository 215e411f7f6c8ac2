#include "core/frame/frame_content.h"

#include <gtest/gtest.h>

#include <array>

namespace hermite::frame::frame_content_test {
namespace {

constexpr double kUnitsPerMetre = 1000;

RgbdFrame uniform(std::uint16_t depth, Rgb8 color) {
  RgbdFrame frame;
  frame.depth = DepthImage(64, 48);
  frame.color = ColorImage(64, 48);
  for (std::uint16_t& d : frame.depth.pixels) d = depth;
  for (Rgb8& c : frame.color.pixels) c = color;
  return frame;
}

TEST(FrameContent, OfAUniformFrame) {
  const FrameContent content =
      content_of(uniform(1500, {100, 100, 100}), kUnitsPerMetre, FrameOptions{});
  EXPECT_EQ(content.in_range, 1);
  EXPECT_EQ(content.too_near + content.too_far, 0);
  EXPECT_EQ(content.median_m, 1.5);
  EXPECT_EQ(content.mean_grey, 100);
  EXPECT_EQ(content.texture, 0);
}

TEST(FrameContent, DepthIsNearFarInRangeOrNotThere) {
  RgbdFrame frame = uniform(0, {});
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      frame.depth.at(x, y) =
          std::array<std::uint16_t, 4>{0, 200, 2000, 9000}[static_cast<std::size_t>(x / 16)];
  const FrameContent content = content_of(frame, kUnitsPerMetre, FrameOptions{});
  EXPECT_EQ(content.too_near, 0.25);
  EXPECT_EQ(content.in_range, 0.25);
  EXPECT_EQ(content.too_far, 0.25);
  EXPECT_EQ(content.median_m, 2);
}

TEST(FrameContent, TheMedianIsOfDepthsInRange) {
  RgbdFrame frame = uniform(1000, {});
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 20; ++x) frame.depth.at(x, y) = 4000;
  EXPECT_EQ(content_of(frame, kUnitsPerMetre, FrameOptions{}).median_m, 1);
}

// Grey weighs the channels by 0.299, 0.587, 0.114; every second column of white makes every change
// to the right one of 255.
TEST(FrameContent, OfTheImage) {
  EXPECT_EQ(content_of(uniform(0, {255, 0, 0}), kUnitsPerMetre, FrameOptions{}).mean_grey, 76);
  RgbdFrame stripes = uniform(0, {});
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; x += 2) stripes.color.at(x, y) = {255, 255, 255};
  EXPECT_EQ(content_of(stripes, kUnitsPerMetre, FrameOptions{}).texture, 127.5);
}

TEST(FrameContent, EqualDepthAloneHasAnEqualDigest) {
  const auto digest = [](const RgbdFrame& frame) {
    return content_of(frame, kUnitsPerMetre, FrameOptions{}).depth_digest;
  };
  RgbdFrame frame = uniform(1000, {});
  const std::uint64_t before = digest(frame);
  EXPECT_EQ(digest(uniform(1000, {9, 9, 9})), before);
  frame.depth.at(33, 7) = 1001;  // between the pixels that are looked at
  EXPECT_NE(digest(frame), before);
  EXPECT_EQ(digest(uniform(0, {})), 0u) << "nothing is measured, and that may be so again";
}

TEST(FrameContent, OfAnEmptyImageIsNothing) {
  EXPECT_EQ(content_of(RgbdFrame{}, kUnitsPerMetre, FrameOptions{}).in_range, 0);
}

}  // namespace
}  // namespace hermite::frame::frame_content_test
