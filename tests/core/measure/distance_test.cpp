#include "core/measure/distance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/measured_places.h"

namespace hermite::measure {
namespace distance_test {

using Eigen::Vector3d;
using ::testing::HasSubstr;

// Its error along z.
MeasuredPlace point_at(double x, double z) { return test::place_at({x, 0, z}, {0, 0, -1}); }

TEST(Distance, ErrorsAlongTheLineCount) {
  const MapKnowledge map = test::seen_from({0});
  const Result<Quantity> along = distance_between(point_at(0, 2), point_at(0, 3), map);
  ASSERT_TRUE(along.ok());
  EXPECT_EQ(along->kind, MeasureKind::kDistance);
  EXPECT_DOUBLE_EQ(along->value, 1);
  EXPECT_NEAR(along->surface_sigma, 0.001 * std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(along->half_width, 1.96 * std::hypot(along->surface_sigma, along->pose_sigma), 1e-12);
  const Result<Quantity> across = distance_between(point_at(-0.5, 2), point_at(0.5, 2), map);
  ASSERT_TRUE(across.ok());
  EXPECT_NEAR(across->surface_sigma, 0, 1e-9) << "on one wall";
  EXPECT_LT(across->half_width, along->half_width);
}

TEST(Distance, ItIsKnownWorseTheFartherTheCameraHasGone) {
  const auto half_width_m = [](const MapKnowledge& map) {
    return or_throw(distance_between(point_at(0, 2), point_at(1, 2), map)).half_width;
  };
  EXPECT_GT(half_width_m(test::seen_from({-1, -5, 2.1})),
            1.5 * half_width_m(test::seen_from({0.5})));
}

TEST(Distance, OnePlaceHasNone) {
  const Result<Quantity> none =
      distance_between(point_at(0, 2), point_at(0, 2.004), test::seen_from({0}));
  ASSERT_FALSE(none.ok());
  EXPECT_THAT(none.error().message, HasSubstr("same place"));
}

TEST(Height, OnlyWhatIsAlongUpCountsAndUpItselfIsOff) {
  const MapKnowledge map = test::seen_from({0});
  const MeasuredPlace low = test::place_at({-0.5, 0.4, 2}, {0, 0, -1}),
                      high = test::place_at({0.7, -0.3, 3}, {0, 0, -1});
  const Quantity height = or_throw(height_between(low, high, {0, -1, 0}, map));
  EXPECT_EQ(height.kind, MeasureKind::kHeight);
  EXPECT_NEAR(height.value, 0.7, 1e-12);
  EXPECT_EQ(or_throw(height_between(high, low, {0, -1, 0}, map)).value, height.value)
      << "whichever is the higher one";
  EXPECT_NEAR(height.surface_sigma, 0, 1e-12) << "both walls stand upright";
  EXPECT_GT(height.pose_sigma, kUpSigma_rad * std::hypot(1.2, 1.0));
  const Quantity above = or_throw(height_between(
      test::place_at({0, 0.4, 2}, {0, -1, 0}), test::place_at({0, -0.3, 2}, {0, 1, 0}), {0, -1, 0},
      MapKnowledge{CameraWay({{0, Rigid3{}}, {1, Rigid3{}}}), 1, false}));
  EXPECT_NEAR(above.surface_sigma, 0.001 * std::sqrt(2.0), 1e-9);
  EXPECT_LT(above.pose_sigma, height.pose_sigma);
  EXPECT_FALSE(height_between(low, low, {0, -1, 0}, map).ok());
}

}  // namespace distance_test
}  // namespace hermite::measure
