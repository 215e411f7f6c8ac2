#include "core/track/place_doubt.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/track/pose_uncertainty.h"

namespace hermite::track::place_doubt_test {
namespace {

// A stretch of surface from x = 0.
Eigen::AlignedBox3d stretch(double length_m) {
  return {Eigen::Vector3d::Zero(), Eigen::Vector3d(length_m, 0.5, 0.5)};
}

PlaceDoubt after(double unseen_s, double known_m = 20) {
  PlaceDoubt doubt;
  doubt.count_gap({.unseen_s = unseen_s}, known_m);
  return doubt;
}

TEST(PlaceDoubt, ShortGapsAreWithinTheReachOfTracking) {
  EXPECT_FALSE(PlaceDoubt::is_cast_by({}));
  EXPECT_FALSE(PlaceDoubt::is_cast_by({.unseen_s = 0.2}));
  EXPECT_FALSE(PlaceDoubt::is_cast_by({.unseen_s = std::nan("")}));
  EXPECT_TRUE(PlaceDoubt::is_cast_by({.unseen_s = 0.5}));
}

TEST(PlaceDoubt, IsSettledByAsMuchKnownSurfaceAsTheCameraMayHaveWalked) {
  PlaceDoubt doubt = after(2);
  EXPECT_EQ(doubt.elsewhere_m(), 2);
  doubt.observe({}, true);
  doubt.observe(stretch(1.5), true);
  EXPECT_EQ(doubt.elsewhere_m(), 2);
  Eigen::AlignedBox3d further = stretch(1);
  doubt.observe(further.translate(Eigen::Vector3d(1.2, 0, 0)), true);
  EXPECT_EQ(doubt.elsewhere_m(), 0) << "2.2 m, seen in two frames";
}

TEST(PlaceDoubt, ReachesAsFarAsTheJumpToThePlaceWhereTheCameraWasRelocalised) {
  EXPECT_TRUE(PlaceDoubt::is_cast_by({.unseen_s = 0.1, .jump_m = 0.5}));
  EXPECT_FALSE(PlaceDoubt::is_cast_by({.unseen_s = 0.1, .jump_m = 0.2}));
  PlaceDoubt doubt;
  doubt.count_gap({.unseen_s = 0.5, .jump_m = 1.9}, 20);
  EXPECT_EQ(doubt.elsewhere_m(), 1.9);
  doubt.observe(stretch(1.8), true);
  EXPECT_EQ(doubt.elsewhere_m(), 1.9) << "less than the distance to the twin";
  doubt.observe(stretch(2), true);
  EXPECT_EQ(doubt.elsewhere_m(), 0);
}

TEST(PlaceDoubt, NobodyIsFoundFartherAwayThanAPersonInHasteCanBe) {
  EXPECT_LT(PlaceDoubt::reach_m(0.5), 1.9);
  EXPECT_GT(PlaceDoubt::reach_m(2), 4);
}

TEST(PlaceDoubt, WhatRecursElsewhereSettlesNothing) {
  PlaceDoubt doubt = after(2);
  doubt.observe(stretch(5), false);
  EXPECT_EQ(doubt.elsewhere_m(), 2);
  doubt.observe({}, true);
  EXPECT_EQ(doubt.elsewhere_m(), 0) << "the stretch was seen before";
}

TEST(PlaceDoubt, AfterALongTimeMoreThanWhatIsMadeInSeriesSuffices) {
  PlaceDoubt doubt = after(60);
  EXPECT_EQ(doubt.elsewhere_m(), 10) << "not a minute's walk";
  doubt.observe(stretch(2.9), true);
  EXPECT_GT(doubt.elsewhere_m(), 0);
  doubt.observe(stretch(3.1), true);
  EXPECT_EQ(doubt.elsewhere_m(), 0);
}

TEST(PlaceDoubt, OfASmallObjectNearlyAllIsEnough) {
  PlaceDoubt doubt = after(60, 1);
  doubt.observe(stretch(0.7), true);
  EXPECT_GT(doubt.elsewhere_m(), 0);
  doubt.observe(stretch(0.85), true);
  EXPECT_EQ(doubt.elsewhere_m(), 0);
}

TEST(PlaceDoubt, AnotherGapAddsToIt) {
  PlaceDoubt doubt = after(1);
  doubt.observe(stretch(0.9), true);
  doubt.count_gap({.unseen_s = 1}, 20);
  EXPECT_EQ(doubt.elsewhere_m(), 2);
  doubt.observe({}, true);
  EXPECT_GT(doubt.elsewhere_m(), 0)
      << "what was seen before the second gap tells nothing of the place after it";
}

TEST(PlaceDoubt, ATwinThatIsTurnedAroundLiesOnTheBorderOfTheStatedRegion) {
  const Matrix6d moment = after(2).second_moment();
  Vector6d error;
  error << 2, 0, 0, 0, M_PI, 0;
  EXPECT_NEAR(error.dot(moment.ldlt().solve(error)), kRegion99, 1e-9);
  EXPECT_TRUE(PlaceDoubt().second_moment().isZero());
}

TEST(PlaceDoubt, GoesOnFromWhatWasSaved) {
  PlaceDoubt before = after(2);
  before.observe(stretch(1.9), false);
  ByteWriter bytes;
  before.save(bytes);
  const std::string saved = bytes.take();
  PlaceDoubt restored;
  ByteReader reader(saved);
  restored.restore(reader);
  EXPECT_TRUE(reader.ok() && reader.at_end());
  EXPECT_EQ(restored.elsewhere_m(), 2);
  Eigen::AlignedBox3d further = stretch(0.1);
  restored.observe(further.translate(Eigen::Vector3d(2, 0, 0)), true);
  EXPECT_EQ(restored.elsewhere_m(), 0);
  for (std::size_t size = 0; size < saved.size(); ++size) {
    PlaceDoubt cut;
    ByteReader short_reader(std::string_view(saved).substr(0, size));
    cut.restore(short_reader);
    EXPECT_FALSE(short_reader.ok()) << size;
  }
}

}  // namespace
}  // namespace hermite::track::place_doubt_test
