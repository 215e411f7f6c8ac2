#include "core/measure/surface_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace hermite::measure {
namespace surface_fit_test {

using ::testing::HasSubstr;

// A centimetre apart, z = 0 for x up to `end`, with a uniform noise of that standard deviation, the
// same each time.
output::Cloud floor_up_to(float end, float noise_m) {
  output::Cloud cloud;
  std::minstd_rand random(1);
  for (int i = -12; i <= 12; ++i)
    for (int j = -12; j <= 12; ++j) {
      output::CloudPoint point;
      const float noise =
          static_cast<float>(random()) / static_cast<float>(std::minstd_rand::max()) - 0.5f;
      point.position_m = {0.01f * static_cast<float>(i), 0.01f * static_cast<float>(j),
                          noise_m * std::sqrt(12.0f) * noise};
      if (point.position_m.x() > end) continue;
      point.normal = {0, 0, -1};
      point.confidence = 5;
      cloud.push_back(point);
    }
  return cloud;
}

TEST(SurfaceFit, ThePickIsBroughtToThePlaneAndNoiseAveragesOut) {
  const output::Cloud cloud = floor_up_to(1, 0.002f);
  const Result<MeasuredPlace> found = fit_surface_point(cloud, {0.003, 0.004, -0.005});
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_NEAR(found->position_m.x(), 0.003, 0.001);
  EXPECT_NEAR(found->position_m.y(), 0.004, 0.001);
  EXPECT_NEAR(found->position_m.z(), 0, 0.001);
  EXPECT_LT(found->normal.z(), -0.99);
  EXPECT_GE(found->normal_sigma_m, std::abs(found->position_m.z()));
  EXPECT_LT(found->normal_sigma_m, 0.01);
  const Result<MeasuredPlace> clean = fit_surface_point(floor_up_to(1, 0), {0.003, 0.004, -0.005});
  ASSERT_TRUE(clean.ok());
  EXPECT_LT(clean->normal_sigma_m, 0.5 * found->normal_sigma_m) << "less noise is known better";
}

TEST(SurfaceFit, WhereTheSurfaceBendsLittleIsSaidToBeKnown) {
  output::Cloud cloud = floor_up_to(0, 0);
  constexpr float kRadius_m = 0.03f;
  for (int i = 1; i <= 6; ++i)  // goes on as a rounded edge
    for (int j = -12; j <= 12; ++j) {
      const float turn_rad = 0.25f * static_cast<float>(i);
      output::CloudPoint point;
      point.position_m = {kRadius_m * std::sin(turn_rad), 0.01f * static_cast<float>(j),
                          kRadius_m * (1 - std::cos(turn_rad))};
      point.normal = {std::sin(turn_rad), 0, -std::cos(turn_rad)};
      point.confidence = 5;
      cloud.push_back(point);
    }
  const Result<MeasuredPlace> at_edge = fit_surface_point(cloud, {0.008, 0, 0.001}),
                              beside = fit_surface_point(cloud, {-0.06, 0, 0});
  ASSERT_TRUE(at_edge.ok() && beside.ok());
  EXPECT_LT(beside->normal_sigma_m, 0.0005);
  EXPECT_GT(at_edge->normal_sigma_m, 4 * beside->normal_sigma_m);
  const Eigen::Vector3d from_axis = at_edge->position_m - Eigen::Vector3d(0, 0, kRadius_m);
  EXPECT_LT(std::abs(std::hypot(from_axis.x(), from_axis.z()) - kRadius_m),
            2 * at_edge->normal_sigma_m);
}

TEST(SurfaceFit, TheOtherSideOfAPanelDoesNotCount) {
  output::Cloud cloud = floor_up_to(1, 0);
  for (output::CloudPoint point : floor_up_to(1, 0)) {
    point.position_m.z() += 0.012f;
    point.normal = -point.normal;
    cloud.push_back(point);
  }
  const Result<MeasuredPlace> found = fit_surface_point(cloud, {0, 0, -0.002});
  ASSERT_TRUE(found.ok());
  EXPECT_NEAR(found->position_m.z(), 0, 1e-4);
}

TEST(SurfaceFit, WhereThereIsNothingItSaysSo) {
  const output::Cloud cloud = floor_up_to(1, 0);
  const Result<MeasuredPlace> far = fit_surface_point(cloud, {0, 0, 0.5});
  ASSERT_FALSE(far.ok());
  EXPECT_EQ(far.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(far.error().message, HasSubstr("6 cm"));
  EXPECT_FALSE(fit_surface_point({}, {0, 0, 0}).ok());
  const Result<MeasuredPlace> no_number =
      fit_surface_point(cloud, {0, std::numeric_limits<double>::quiet_NaN(), 0});
  ASSERT_FALSE(no_number.ok());
  EXPECT_EQ(no_number.error().code, ErrorCode::kInvalidArgument);
}

TEST(SurfaceFit, PointsThatAreNoNumbersAreLeftOut) {
  output::Cloud cloud = floor_up_to(1, 0);
  output::CloudPoint broken = cloud.front();
  broken.position_m = {0, 0, std::numeric_limits<float>::quiet_NaN()};
  cloud.push_back(broken);
  broken = cloud[300];
  broken.normal.setConstant(std::numeric_limits<float>::quiet_NaN());
  cloud.push_back(broken);
  broken = cloud[300];
  broken.confidence = std::numeric_limits<float>::quiet_NaN();
  cloud.push_back(broken);
  const Result<MeasuredPlace> found = fit_surface_point(cloud, {0, 0, 0});
  ASSERT_TRUE(found.ok());
  EXPECT_TRUE(found->position_m.allFinite());
  EXPECT_TRUE(std::isfinite(found->normal_sigma_m));
}

}  // namespace surface_fit_test
}  // namespace hermite::measure
