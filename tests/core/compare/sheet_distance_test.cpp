#include "core/compare/sheet_distance.h"

#include <gtest/gtest.h>

#include "tests/support/plane_cloud.h"

namespace hermite::compare::sheet_distance_test {

constexpr double kMiddle_m = 0.2;

output::Cloud plane_at(double z_m, bool is_turned = false) {
  output::Cloud cloud = test::plane_cloud(40);
  for (output::CloudPoint& point : cloud) {
    point.position_m.z() = static_cast<float>(z_m);
    if (is_turned) point.normal = -point.normal;
  }
  return cloud;
}

ComparedScan scan_of(output::Cloud cloud) {
  return or_throw(ComparedScan::create(std::move(cloud), {}, "scan"));
}

measure::MeasuredPlace place() {
  return *place_at(scan_of(plane_at(1)), {kMiddle_m, kMiddle_m, 1});
}

TEST(SheetDistance, IsSignedAlongTheNormal) {
  const std::optional<SheetDistance> nearer = sheet_distance(place(), scan_of(plane_at(0.98)),
                                                             kSheetReach_m),
                                     farther = sheet_distance(place(), scan_of(plane_at(1.03)),
                                                              kSheetReach_m);
  ASSERT_TRUE(nearer && farther);
  EXPECT_NEAR(nearer->distance_m, 0.02, 1e-4) << "towards the camera, to which the normal points";
  EXPECT_NEAR(farther->distance_m, -0.03, 1e-4);
  EXPECT_GT(nearer->sigma_m, 0);
  EXPECT_FALSE(sheet_distance(place(), scan_of(plane_at(1.03)), 0.02)) << "beyond the reach";
}

TEST(SheetDistance, TheNearestLayerCountsAndTheBackOfAThingIsNone) {
  output::Cloud layers = plane_at(1.01), other = plane_at(0.94);
  layers.insert(layers.end(), other.begin(), other.end());
  const std::optional<SheetDistance> found =
      sheet_distance(place(), scan_of(layers), kSheetReach_m);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->distance_m, -0.01, 1e-4);
  EXPECT_FALSE(sheet_distance(place(), scan_of(plane_at(1.01, true)), kSheetReach_m));
}

TEST(SheetDistance, NearestSurfelIsOfAnySide) {
  EXPECT_NEAR(nearest_surfel_m({kMiddle_m, kMiddle_m, 1}, scan_of(plane_at(1.01, true)), 0.05),
              0.01, 1e-5);
  EXPECT_EQ(nearest_surfel_m({kMiddle_m, kMiddle_m, 1}, scan_of(plane_at(1.2)), 0.05), 0.05);
}

}  // namespace hermite::compare::sheet_distance_test
