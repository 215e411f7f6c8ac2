#include "core/thumbnail/disc_view.h"

#include <gtest/gtest.h>

#include <limits>

namespace hermite::thumbnail {
namespace {
namespace disc_view_test {

constexpr Rgb8 kBlack{0, 0, 0};

output::CloudPoint disc(const Eigen::Vector3f& position_m, const Eigen::Vector3f& normal,
                        Rgb8 color, float radius_m = 0.05f) {
  output::CloudPoint point;
  point.position_m = position_m;
  point.normal = normal;
  point.color = color;
  point.radius_m = radius_m;
  return point;
}

TEST(DrawDiscs, ADiscIsAsLargeAsItIs) {
  const DiscImage image =
      draw_discs({disc({0, 0, 1}, {0, 0, -1}, {200, 0, 0})}, {}, 41, 41, kBlack);
  EXPECT_NEAR(static_cast<double>(image.drawn_px), 3.1416 * 25, 4);  // 5 pixels of radius
  EXPECT_GT(image.color.at(20, 20).r, 100);
  EXPECT_EQ(image.color.at(20, 26), kBlack);
  // Turned by 60 degrees about the vertical axis it is half as wide.
  const DiscImage oblique = draw_discs(
      {disc({0, 0, 1}, Eigen::Vector3f(0.866f, 0, -0.5f), {200, 0, 0})}, {}, 41, 41, kBlack);
  EXPECT_NEAR(static_cast<double>(oblique.drawn_px), 3.1416 * 25 / 2, 6);
  EXPECT_GT(oblique.color.at(20, 24).r, 0);
  EXPECT_EQ(oblique.color.at(24, 20), kBlack);
}

TEST(DrawDiscs, TheNearerOneIsSeenAndNoneFromBehind) {
  const output::CloudPoint near = disc({0, 0, 1}, {0, 0, -1}, {0, 200, 0}),
                           far = disc({0, 0, 2}, {0, 0, -1}, {200, 0, 0});
  for (const output::Cloud& cloud : {output::Cloud{near, far}, output::Cloud{far, near}})
    EXPECT_GT(draw_discs(cloud, {}, 21, 21, kBlack).color.at(10, 10).g, 100);
  output::CloudPoint wall = near;
  wall.normal = {0, 0, 1};  // a wall of a room, seen from outside
  EXPECT_GT(draw_discs({wall, far}, {}, 21, 21, kBlack).color.at(10, 10).r, 100);
}

TEST(DrawDiscs, WhereDiscsOverlapTheNearestCentreIsSeen) {
  const output::Cloud cloud{disc({-0.03f, 0, 1}, {0, 0, -1}, {200, 0, 0}),
                            disc({0.03f, 0, 1}, {0, 0, -1}, {0, 200, 0})};
  const ColorImage color = draw_discs(cloud, {}, 41, 41, kBlack).color;
  EXPECT_GT(color.at(19, 20).r, 0);
  EXPECT_GT(color.at(21, 20).g, 0);
}

TEST(DrawDiscs, ATinyOneTakesAPixelAndWhatIsOutsideOrNotFiniteNothing) {
  EXPECT_EQ(draw_discs({disc({0, 0, 1}, {0, 0, -1}, {9, 9, 9}, 0)}, {}, 21, 21, kBlack).drawn_px,
            1u);
  const float nan = std::numeric_limits<float>::quiet_NaN(), far = 1e30f;
  EXPECT_EQ(draw_discs({disc({nan, 0, 1}, {0, 0, -1}, {9, 9, 9}),
                        disc({far, -far, 1}, {0, 0, -1}, {9, 9, 9})},
                       {}, 21, 21, kBlack)
                .drawn_px,
            0u);
  EXPECT_EQ(
      draw_discs({disc({0, 0, 1}, {nan, nan, nan}, {9, 9, 9}, 0)}, {}, 21, 21, kBlack).drawn_px,
      1u);
  EXPECT_EQ(draw_discs({disc({0, 0, 1}, {0, 0, -1}, {9, 9, 9}, 1e9f)}, {}, 21, 21, kBlack).drawn_px,
            21u * 21);
}

}  // namespace disc_view_test
}  // namespace
}  // namespace hermite::thumbnail
