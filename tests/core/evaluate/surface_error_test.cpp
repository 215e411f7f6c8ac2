#include "core/evaluate/surface_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace hermite::evaluate {
namespace {

using Eigen::Vector3d;

double distance_to_floor(const Vector3d& point) { return std::abs(point.z()); }

TEST(SurfaceError, HandComputedStatistics) {
  std::vector<Vector3d> points;
  for (int i = 1; i <= 100; ++i) points.push_back({0.1 * i, 0, 0.001 * (i % 2 == 0 ? i : -i)});
  const auto error = surface_error(points, {}, distance_to_floor);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->point_count, 100);
  EXPECT_NEAR(error->mean_m, 0.0505, 1e-12);
  EXPECT_NEAR(error->median_m, 0.0505, 1e-12);
  EXPECT_NEAR(error->rmse_m, 0.001 * std::sqrt(100 * 101 * 201 / 6 / 100.0), 1e-12);
  EXPECT_NEAR(error->percentile95_m, 0.095, 1e-12);
  EXPECT_NEAR(error->max_m, 0.100, 1e-12);
}

TEST(SurfaceError, TheCloudIsMovedIntoTheWorld) {
  const Rigid3 world_from_cloud{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX())),
                                {0, 0, 0.5}};
  // y becomes z: the point at y = -0.4 is 0.1 above the floor.
  EXPECT_NEAR(surface_error({Vector3d(1, -0.4, 2)}, world_from_cloud, distance_to_floor)->mean_m,
              0.1, 1e-12);
}

TEST(SurfaceError, NothingToMeasureIsAnError) {
  EXPECT_EQ(surface_error({}, {}, distance_to_floor).error().code, ErrorCode::kInvalidArgument);
  const auto broken =
      surface_error({Vector3d(0, 0, 0), Vector3d(0, 0, std::nan(""))}, {}, distance_to_floor);
  EXPECT_THAT(broken.error().message, testing::HasSubstr("point 1"));
}

TEST(SurfaceError, JsonHasTheNumbers) {
  const auto json = nlohmann::json::parse(
      format_surface_error_json(*surface_error({Vector3d(0, 0, 0.25)}, {}, distance_to_floor)));
  EXPECT_EQ(json["surface_points"], 1);
  EXPECT_EQ(json["surface_percentile95_m"], 0.25);
}

}  // namespace
}  // namespace hermite::evaluate
