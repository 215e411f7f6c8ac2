#include "core/frame/repaired_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hermite::frame::repaired_depth_test {
namespace {

constexpr double kUnitsPerMetre = 1000;
constexpr int kWidth = 60, kHeight = 40;

bool repair(DepthImage& depth) { return repair_depth(depth, kUnitsPerMetre, FrameOptions{}); }

DepthImage filled_with(std::uint16_t units) {
  DepthImage depth(kWidth, kHeight);
  std::fill(depth.pixels.begin(), depth.pixels.end(), units);
  return depth;
}

// A plane at 2 m, whose inverse depth grows to the right and downwards.
DepthImage slope() {
  DepthImage depth(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      depth.at(x, y) =
          static_cast<std::uint16_t>(std::lround(kUnitsPerMetre / (0.4 + 0.002 * x + 0.001 * y)));
  return depth;
}

TEST(RepairedDepth, AWholeImageStaysAsItIs) {
  const DepthImage before = slope();
  DepthImage depth = before;
  EXPECT_FALSE(repair(depth));
  EXPECT_EQ(depth.pixels, before.pixels);
}

TEST(RepairedDepth, AHoleOfOnePixelGetsThePlanesDepth) {
  const DepthImage before = slope();
  DepthImage depth = before;
  depth.at(20, 10) = depth.at(30, 10) = 0;
  depth.at(40, 20) = depth.at(41, 20) = 0;  // and one of two
  EXPECT_TRUE(repair(depth));
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    ASSERT_NEAR(depth.pixels[i], before.pixels[i], 1) << i;
}

TEST(RepairedDepth, NothingIsPutBetweenTwoSurfaces) {
  DepthImage depth = filled_with(1000);
  for (int y = 0; y < kHeight; ++y) {
    depth.at(30, y) = 0;
    for (int x = 31; x < kWidth; ++x) depth.at(x, y) = 2000;
  }
  const DepthImage before = depth;
  EXPECT_FALSE(repair(depth));
  EXPECT_EQ(depth.pixels, before.pixels);
}

TEST(RepairedDepth, ALargeHoleKeepsItsEdges) {
  DepthImage depth = filled_with(1500);
  for (int y = 10; y < 20; ++y)
    for (int x = 20; x < 40; ++x) depth.at(x, y) = 0;
  repair(depth);
  int left_count = 0;
  for (int y = 10; y < 20; ++y)
    for (int x = 20; x < 40; ++x) left_count += depth.at(x, y) == 0;
  // Without its corners, which lie between two neighbours on a diagonal.
  EXPECT_EQ(left_count, 10 * 20 - 4);
  EXPECT_EQ(depth.at(30, 10), 0);
  EXPECT_EQ(depth.at(20, 15), 0);
}

TEST(RepairedDepth, BordersStayAsTheyAre) {
  DepthImage depth = filled_with(1500);
  depth.at(0, 5) = depth.at(5, 0) = depth.at(kWidth - 1, 5) = depth.at(5, kHeight - 1) = 0;
  EXPECT_FALSE(repair(depth));
}

TEST(RepairedDepth, ADepthThatNoNeighbourSharesIsReplaced) {
  DepthImage depth = filled_with(1500);
  depth.at(20, 10) = 4000;
  depth.at(30, 10) = 700;
  EXPECT_TRUE(repair(depth));
  EXPECT_EQ(depth.pixels, filled_with(1500).pixels);
}

TEST(RepairedDepth, ThinThingsAndLoneSamplesStay) {
  DepthImage depth = filled_with(3000);
  for (int y = 5; y < 30; ++y) depth.at(20, y) = 1000;          // a wire
  for (int i = 0; i < 20; ++i) depth.at(30 + i, 5 + i) = 1000;  // on a diagonal
  DepthImage before = depth;
  EXPECT_FALSE(repair(depth));
  EXPECT_EQ(depth.pixels, before.pixels);

  DepthImage sparse(kWidth, kHeight);  // samples at every fourth pixel
  for (int y = 0; y < kHeight; y += 4)
    for (int x = 0; x < kWidth; x += 4) sparse.at(x, y) = x % 8 == 0 ? 1000 : 3000;
  before = sparse;
  EXPECT_FALSE(repair(sparse));
  EXPECT_EQ(sparse.pixels, before.pixels);
}

TEST(RepairedDepth, ASurfaceOfWhichHalfIsMeasuredIsNearlyWhole) {
  std::mt19937 random(7);
  const DepthImage whole = slope();
  DepthImage depth = whole;
  for (std::uint16_t& pixel : depth.pixels) {
    const auto event = random() % 100;
    if (event < 50) pixel = 0;
    if (event == 99) pixel = static_cast<std::uint16_t>(500 + random() % 4500);
  }
  EXPECT_TRUE(repair(depth));
  int hole_count = 0, wrong_count = 0;
  for (int y = 1; y + 1 < kHeight; ++y)
    for (int x = 1; x + 1 < kWidth; ++x) {
      hole_count += depth.at(x, y) == 0;
      wrong_count += depth.at(x, y) != 0 && std::abs(depth.at(x, y) - whole.at(x, y)) > 100;
    }
  EXPECT_LT(hole_count, kWidth * kHeight / 20);
  EXPECT_LE(wrong_count, 3);  // of some 23 that were anywhere, two side by side
}

// Neighbours at 4.5 m often differ by more than half the gate.
TEST(RepairedDepth, NoiseIsNotRemoved) {
  std::mt19937 random(3);
  const FrameOptions options;
  const double beyond_m = 4.5 - 0.4;
  std::normal_distribution<double> noise_m(
      0, options.noise_floor_m + options.noise_growth_per_m * beyond_m * beyond_m);
  DepthImage depth(kWidth, kHeight);
  for (std::uint16_t& pixel : depth.pixels)
    pixel = static_cast<std::uint16_t>(std::lround((4.5 + noise_m(random)) * kUnitsPerMetre));
  const DepthImage before = depth;
  repair(depth);
  int changed_count = 0;
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    changed_count += depth.pixels[i] != before.pixels[i];
  EXPECT_LE(changed_count, kWidth * kHeight / 1000);
}

TEST(RepairedDepth, TheFarthestAndTheSmallestImages) {
  DepthImage depth = filled_with(65535);
  depth.at(10, 10) = 0;
  EXPECT_TRUE(repair(depth));
  EXPECT_EQ(depth.at(10, 10), 65535);
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 9}, {9, 2}, {3, 3}}) {
    DepthImage small(width, height);
    EXPECT_FALSE(repair(small));
  }
}

}  // namespace
}  // namespace hermite::frame::repaired_depth_test
