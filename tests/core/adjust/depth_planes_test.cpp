#include "core/adjust/depth_planes.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "core/disturb/depth_noise.h"
#include "tests/core/adjust/plane_world.h"

namespace hermite::adjust {
namespace {

Eigen::Vector3d vector_of(const DepthPlane& plane) { return {plane[0], plane[1], plane[2]}; }

bool is_none(const DepthPlane& plane) { return plane == DepthPlane{}; }

int count_of(const std::vector<DepthPlane>& planes) {
  return static_cast<int>(std::count_if(planes.begin(), planes.end(),
                                        [](const DepthPlane& plane) { return !is_none(plane); }));
}

// The wall stands at 2 m, turned by so much about the vertical.
Eigen::Vector3d wall(double turn_rad) {
  return Eigen::Vector3d(std::sin(turn_rad), 0, std::cos(turn_rad)) / (2 * std::cos(turn_rad));
}

TEST(DepthPlanes, AGridIsEightyCellsAcrossWhateverTheImage) {
  EXPECT_EQ(depth_grid_of(kPlaneCamera).cell_px, 4);
  EXPECT_EQ(depth_grid_of(kPlaneCamera).count(), 80u * 60u);
  Camera camera{640, 480, 525, 525, 319.5, 239.5, 5000};
  EXPECT_EQ(depth_grid_of(camera).count(), 80u * 60u);
  camera.width = camera.height = kMinImageSide_px;
  EXPECT_EQ(depth_grid_of(camera).count(), 32u * 32u) << "a cell has at least two pixels a side";
}

TEST(DepthPlanes, AWallIsThePlaneThatItIs) {
  const Eigen::Vector3d truth = wall(0.5);
  const std::vector<DepthPlane> planes =
      fit_depth_planes(depth_of({truth}, kPlaneCamera), kPlaneCamera);
  ASSERT_EQ(planes.size(), depth_grid_of(kPlaneCamera).count());
  EXPECT_GT(count_of(planes), 78 * 58 - 1) << "all but the rim";
  for (const DepthPlane& plane : planes) {
    if (is_none(plane)) continue;
    EXPECT_LT((vector_of(plane) - truth).norm(), 0.02 * truth.norm())
        << "steps of the sensor, 0.2 mm";
  }
}

TEST(DepthPlanes, ASensorsNoiseLeavesMostOfAWall) {
  const DepthImage depth = disturb::add_noise(depth_of({wall(0.3)}, kPlaneCamera), kPlaneCamera,
                                              {.model = disturb::NoiseModel::kKinect}, 0);
  EXPECT_GT(count_of(fit_depth_planes(depth, kPlaneCamera)), 80 * 60 * 6 / 10);
}

TEST(DepthPlanes, WhereTwoWallsMeetThereIsNone) {
  // The corner runs through the middle of the image, at 2 m.
  const std::vector<DepthPlane> planes =
      fit_depth_planes(depth_of({wall(0.6), wall(-0.6)}, kPlaneCamera), kPlaneCamera);
  const DepthGrid grid = depth_grid_of(kPlaneCamera);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const double from_corner_px = std::abs(grid.center_px(column) - kPlaneCamera.cx);
      const DepthPlane& plane = planes[grid.index(column, row)];
      const bool is_near = from_corner_px < grid.cell_px / 2,
                 is_inside = from_corner_px < 130 && row > 0 && row < grid.rows - 1;
      const bool is_far = from_corner_px > 2 * grid.cell_px && is_inside;
      if (is_near || is_far) {
        EXPECT_EQ(is_none(plane), is_near) << column << " " << row;
      }
    }
}

TEST(DepthPlanes, AnEdgeAHoleAndWhatIsFarHaveNone) {
  DepthImage depth = depth_of({wall(0)}, kPlaneCamera);
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u) {
      if (u < 100) depth.at(u, v) = 5000;              // a board before the wall
      if (u > 200 && v < 100) depth.at(u, v) = 0;      // a hole
      if (u > 200 && v > 150) depth.at(u, v) = 30000;  // 6 m
    }
  const std::vector<DepthPlane> planes = fit_depth_planes(depth, kPlaneCamera);
  const DepthGrid grid = depth_grid_of(kPlaneCamera);
  const auto has = [&](int u, int v) {
    return !is_none(planes[grid.index(u / grid.cell_px, v / grid.cell_px)]);
  };
  EXPECT_TRUE(has(50, 120));
  EXPECT_TRUE(has(150, 120));
  for (const int u : {97, 101, 103}) EXPECT_FALSE(has(u, 120)) << u;
  EXPECT_FALSE(has(250, 50));
  EXPECT_FALSE(has(250, 200));
  EXPECT_FALSE(has(199, 50));
}

TEST(DepthPlanes, WhatIsSeenAlongItsSurfaceHasNone) {
  const Eigen::Vector3d truth = wall(1.35);
  const std::vector<DepthPlane> planes =
      fit_depth_planes(depth_of({truth}, kPlaneCamera), kPlaneCamera);
  const DepthGrid grid = depth_grid_of(kPlaneCamera);
  int seen = 0, unseen = 0;
  for (int column = 1; column < grid.columns - 1; ++column) {
    const Eigen::Vector3d ray = kPlaneCamera.unproject(grid.center_px(column), kPlaneCamera.cy, 1);
    const double cosine = truth.normalized().dot(ray.normalized()), depth_m = 1 / truth.dot(ray);
    if (depth_m < 0.35 || depth_m > 4.5 || std::abs(cosine - 0.3) < 0.03) continue;
    EXPECT_EQ(is_none(planes[grid.index(column, grid.rows / 2)]), cosine < 0.3)
        << column << " " << cosine;
    ++(cosine < 0.3 ? unseen : seen);
  }
  EXPECT_GT(seen, 5);
  EXPECT_GT(unseen, 5);
}

TEST(DepthPlanes, AnEmptyImageHasNone) {
  EXPECT_EQ(count_of(fit_depth_planes(DepthImage(320, 240), kPlaneCamera)), 0);
}

}  // namespace
}  // namespace hermite::adjust
