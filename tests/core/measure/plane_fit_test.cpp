#include "core/measure/plane_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "tests/support/measured_places.h"

namespace hermite::measure {
namespace plane_fit_test {

using Eigen::Vector3d;
using ::testing::HasSubstr;

// A centimetre apart over a square metre and a half, at the depth that `z_m` says, none where that
// is none. Uniform noise.
output::Cloud wall(const std::function<double(double x_m, double y_m)>& z_m, double noise_m = 0,
                   const Eigen::Vector3f& normal = {0, 0, -1}) {
  output::Cloud cloud;
  std::minstd_rand random(1);
  for (int i = -75; i <= 75; ++i)
    for (int j = -75; j <= 75; ++j) {
      const double x_m = 0.01 * i, y_m = 0.01 * j;
      const double noise =
          static_cast<double>(random()) / static_cast<double>(std::minstd_rand::max()) - 0.5;
      output::CloudPoint point;
      point.position_m =
          Vector3d(x_m, y_m, z_m(x_m, y_m) + noise_m * std::sqrt(12.0) * noise).cast<float>();
      point.normal = normal;
      point.confidence = 5;
      if (point.position_m.allFinite()) cloud.push_back(point);
    }
  return cloud;
}

constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
const MeasuredPlace kMiddle = test::place_at({0, 0, 2}, {0, 0, -1});

TEST(PlaneFit, NoiseAveragesOutOverTheWholeWall) {
  const output::Cloud cloud = wall([](double x_m, double) { return 2 + 0.1 * x_m; }, 0.002,
                                   Eigen::Vector3f(0.1f, 0, -1).normalized());
  // Place as a small fit has it.
  const MeasuredPlace place = test::place_at({0, 0, 2.001}, Vector3d(0.11, 0.01, -1).normalized());
  const Result<MeasuredPlane> plane = fit_plane(cloud, place, false);
  ASSERT_TRUE(plane.ok()) << plane.error().message;
  const Vector3d truth = Vector3d(0.1, 0, -1).normalized();
  const double off_rad = std::acos(std::min(1.0, plane->place.normal.dot(truth)));
  EXPECT_LT(off_rad, 0.0005);
  EXPECT_LT(off_rad, 1.96 * std::hypot(plane->slope_sigma[0], plane->slope_sigma[1]));
  EXPECT_NEAR(plane->place.position_m.z(), 2, 0.0003);
  EXPECT_LT(plane->place.normal_sigma_m, 0.001);
  EXPECT_GT(plane->sigma_at_m({4, 0, 2.4}), 2 * plane->sigma_at_m({0, 0, 2}))
      << "far from what was seen it is known worse";
}

TEST(PlaneFit, ItEndsWhereTheWallDoes) {
  // A door that stands back by 3 cm, and another wall in the same plane beyond a gap.
  const auto z_m = [](double x_m, double) { return x_m < 0.3 ? 2 : x_m < 0.5 ? 2.03 : 2; };
  const Result<MeasuredPlane> plane = fit_plane(wall(z_m), kMiddle, false);
  ASSERT_TRUE(plane.ok());
  EXPECT_NEAR(plane->place.position_m.z(), 2, 1e-5);
  EXPECT_LT(plane->centre_m.x(), -0.15) << "what lies beyond is not taken";
  EXPECT_LT(plane->unevenness_m, 1e-5);
}

TEST(PlaneFit, ABentWallIsKnownWorseThanAFlatOne) {
  const MeasuredPlane flat =
      or_throw(fit_plane(wall([](double, double) { return 2; }, 0.0005), kMiddle, false));
  const MeasuredPlane bent = or_throw(
      fit_plane(wall([](double x_m, double) { return 2 + 0.0015 * std::sin(8 * x_m); }, 0.0005),
                kMiddle, false));
  EXPECT_GT(bent.unevenness_m, 3 * flat.unevenness_m);
  EXPECT_GT(bent.slope_sigma[0] + bent.slope_sigma[1], flat.slope_sigma[0] + flat.slope_sigma[1]);
}

TEST(PlaneFit, WhatIsNoPlaneIsRefused) {
  const auto message_of = [](const output::Cloud& cloud) {
    const Result<MeasuredPlane> plane = fit_plane(cloud, kMiddle, false);
    return plane.ok() ? std::string() : plane.error().message;
  };
  EXPECT_THAT(message_of({}), HasSubstr("too broken"));
  EXPECT_THAT(message_of(wall([](double x_m, double) { return 2 + 0.5 * x_m * x_m; })),
              HasSubstr("bends"))
      << "a column";
  EXPECT_THAT(
      message_of(wall([](double x_m, double) { return std::abs(x_m) < 0.03 ? 2 : kNowhere; })),
      HasSubstr("too small"))
      << "a slat";
  EXPECT_THAT(message_of(wall([](double x_m, double y_m) {
                return std::hypot(x_m, y_m) < 0.04 ? 2 : kNowhere;
              })),
              HasSubstr("too small"));
}

TEST(PlaneFit, OfAMapInPartsOnlyOneIsTaken) {
  output::Cloud cloud = wall([](double, double) { return 2; });
  for (output::CloudPoint& point : cloud)
    if (point.position_m.x() > 0.2f) point.submap = 1;
  EXPECT_NEAR(or_throw(fit_plane(cloud, kMiddle, false)).centre_m.x(), 0, 0.01);
  EXPECT_LT(or_throw(fit_plane(cloud, kMiddle, true)).centre_m.x(), -0.1);
}

}  // namespace plane_fit_test
}  // namespace hermite::measure
