#include "core/frame/repeated_rows.h"

#include <gtest/gtest.h>

#include <random>

namespace hermite::frame::repeated_rows_test {
namespace {

// Noise, as every sensor has it.
DepthImage noisy(unsigned seed) {
  DepthImage depth(64, 48);
  std::mt19937 chance(seed);
  for (std::uint16_t& value : depth.pixels) value = static_cast<std::uint16_t>(2000 + chance() % 8);
  return depth;
}

DepthImage torn(DepthImage depth, const DepthImage& before, int row_count) {
  for (int y = depth.height - row_count; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) depth.at(x, y) = before.at(x, y);
  return depth;
}

int count(const DepthImage& before, const DepthImage& now) {
  return repeated_row_count(digest_rows(before), digest_rows(now));
}

TEST(RepeatedRows, AreThoseLeftFromTheFrameBefore) {
  const DepthImage before = noisy(1), now = noisy(2);
  EXPECT_EQ(count(before, now), 0);
  for (const int row_count : {4, 20, 47})
    EXPECT_EQ(count(before, torn(now, before, row_count)), row_count);
}

TEST(RepeatedRows, AFewAreChanceAndAllAreARepeatedFrame) {
  const DepthImage before = noisy(1);
  EXPECT_EQ(count(before, torn(noisy(2), before, 3)), 0);
  EXPECT_EQ(count(before, before), 0);
}

TEST(RepeatedRows, RowsWithoutDepthTellNothing) {
  DepthImage before = noisy(1), now = torn(noisy(2), before, 20);
  for (DepthImage* depth : {&before, &now})
    for (int y = 40; y < 48; ++y)
      for (int x = 10; x < 64; ++x) depth->at(x, y) = 0;
  EXPECT_EQ(count(before, now), 20) << "8 of them without depth, below the others";
  const DepthImage nothing(64, 48);
  EXPECT_EQ(count(nothing, nothing), 0);
  EXPECT_EQ(count(nothing, now), 0);
  EXPECT_EQ(count(now, nothing), 0);
}

// A rendered scene has no noise: at rest all rows are equal but those where something moves.
TEST(RepeatedRows, ACameraAtRestWithoutNoiseHasThemAboveAsWell) {
  DepthImage before = noisy(1), now = before;
  for (int y = 20; y < 30; ++y) now.at(30, y) = 1000;
  EXPECT_EQ(count(before, now), 0);
}

TEST(RepeatedRows, FramesOfAnotherSizeAreNotCompared) {
  EXPECT_EQ(repeated_row_count({1, 2, 3, 4, 5, 6}, {1, 2, 3, 4, 5}), 0);
}

TEST(RemoveLastRows, LeavesNeitherDepthNorEdges) {
  RgbdFrame frame{0, noisy(1), ColorImage(64, 48)};
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      frame.color.at(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 0};
  RgbdFrame cut = frame;
  remove_last_rows(cut, 10);
  EXPECT_EQ(cut.depth.at(5, 37), frame.depth.at(5, 37));
  EXPECT_EQ(cut.depth.at(5, 38), 0);
  EXPECT_EQ(cut.color.at(5, 47), (Rgb8{5, 37, 0}));
  remove_last_rows(cut, 48);
  EXPECT_NE(cut.depth.at(5, 0), 0) << "one row stays";
}

TEST(TornFrames, GoOnWhereTheyWereSaved) {
  TornFrames all, first;
  const RowDigests before = digest_rows(noisy(1));
  const RowDigests now = digest_rows(torn(noisy(2), noisy(1), 12));
  EXPECT_EQ(first.next(before), 0);
  ByteWriter writer;
  first.save(writer);
  const std::string saved = writer.take();
  ByteReader reader(saved);
  TornFrames second;
  second.restore(reader);
  ASSERT_TRUE(reader.status().ok() && reader.at_end());
  EXPECT_EQ(second.next(now), 12);
  EXPECT_EQ(second.count(), 1);
}

}  // namespace
}  // namespace hermite::frame::repeated_rows_test
