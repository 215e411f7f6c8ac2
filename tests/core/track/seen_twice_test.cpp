#include "core/track/seen_twice.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/coarse_wall.h"

namespace hermite::track::seen_twice_test {
namespace {

using test::coarse_wall;

Rigid3 beside(double distance_m) {
  return exp_se3((Vector6d() << distance_m, 0, 0, 0, 0, 0).finished());
}

TEST(EarlierView, FindsPlacesWhereTheyWereSeen) {
  EarlierView earlier;
  const frame::CoarseMask nothing(4800, 0);
  EXPECT_FALSE(earlier.compare(coarse_wall(2), {}, nothing).has_value());
  earlier.keep(coarse_wall(2), {}, nothing, 0);
  // 0.1 m at 2 m are 3.28 pixels.
  const auto comparison = earlier.compare(coarse_wall(2), beside(0.1), nothing);
  ASSERT_TRUE(comparison.has_value());
  EXPECT_EQ(comparison->places.size(), 77u * 60);
  EXPECT_TRUE(std::all_of(
      comparison->places.begin(), comparison->places.end(), [](const PlaceSeenTwice& place) {
        return place.earlier_x - place.now_x == 3 && place.earlier_y == place.now_y;
      }));
  EXPECT_TRUE(earlier.compare(coarse_wall(1.8), beside(0.1), nothing)->places.empty())
      << "another surface";
}

TEST(EarlierView, LeavesOutWhatMoves) {
  EarlierView earlier;
  frame::CoarseMask left(4800, 0);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i % 80 < 40 ? 1 : 0;
  earlier.keep(coarse_wall(2), {}, left, 0);
  EXPECT_EQ(earlier.compare(coarse_wall(2), {}, frame::CoarseMask(4800, 0))->places.size(), 2400u);
  EXPECT_EQ(earlier.compare(coarse_wall(2), {}, left)->places.size(), 2400u);
}

TEST(EarlierView, IsReplacedWhenLittleOfItIsSeen) {
  const frame::CoarseMask nothing(4800, 0);
  for (const std::size_t found : {4000u, 1000u}) {
    EarlierView earlier;
    earlier.keep(coarse_wall(2), {}, nothing, 0);
    earlier.keep(coarse_wall(3), beside(1), nothing, found);
    EXPECT_EQ(earlier.compare(coarse_wall(3), beside(1), nothing)->places.size(),
              found == 1000 ? 4800u : 0u);
  }
}

TEST(EarlierView, GoesOnFromWhatWasSaved) {
  EarlierView before, after;
  before.keep(coarse_wall(2), beside(0.3), frame::CoarseMask(4800, 0), 0);
  ByteWriter bytes;
  before.save(bytes);
  const std::string saved = bytes.take();
  ByteReader reader(saved);
  after.restore(reader);
  ASSERT_TRUE(reader.status().ok());
  EXPECT_EQ(after.compare(coarse_wall(2), beside(0.3), frame::CoarseMask(4800, 0))->places.size(),
            4800u);
  ByteReader shorter(std::string_view(saved).substr(0, saved.size() / 2));
  after.restore(shorter);
  EXPECT_FALSE(shorter.status().ok());
}

}  // namespace
}  // namespace hermite::track::seen_twice_test
