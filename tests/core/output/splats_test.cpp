#include "core/output/splats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "core/output/spacing.h"

namespace hermite::output {
namespace {

using ::testing::HasSubstr;

// A square grid of 20 x 20 points in a plane with this normal.
Cloud grid_cloud(float spacing_m, const Eigen::Vector3f& normal) {
  const Eigen::Quaternionf turn =
      Eigen::Quaternionf::FromTwoVectors(Eigen::Vector3f::UnitZ(), normal);
  Cloud cloud;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) {
      CloudPoint point;
      point.position_m = turn * Eigen::Vector3f(spacing_m * static_cast<float>(x),
                                                spacing_m * static_cast<float>(y), 0);
      point.normal = normal.normalized();
      point.color = {0, 128, 255};
      point.radius_m = 4 * spacing_m;
      cloud.push_back(point);
    }
  return cloud;
}

std::vector<std::array<float, 17>> splats_of(const Cloud& cloud) {
  const Result<std::string> ply = format_splats(cloud);
  EXPECT_TRUE(ply.ok()) << ply.error().message;
  const std::size_t begin = ply->find("end_header\n") + 11;
  std::vector<std::array<float, 17>> splats((ply->size() - begin) / sizeof(std::array<float, 17>));
  std::memcpy(splats.data(), ply->data() + begin, ply->size() - begin);
  EXPECT_EQ(splats.size(), cloud.size());
  return splats;
}

TEST(Spacing, IsThatOfAGrid) {
  const std::vector<float> spacings = point_spacings_m(grid_cloud(0.01f, {0, 0, 1}));
  EXPECT_NEAR(spacings[10 * 20 + 10], 0.01, 0.0015);
}

TEST(Spacing, IsByTheNeighboursThatAreNearestOfAll) {
  std::mt19937 random(7);
  Cloud cloud(700);
  for (CloudPoint& point : cloud)
    for (int axis = 0; axis < 3; ++axis)
      point.position_m[axis] = static_cast<float>(random() % 1000) / 100;
  const std::vector<float> spacings = point_spacings_m(cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::vector<float> distances;
    for (const CloudPoint& other : cloud)
      distances.push_back((other.position_m - cloud[i].position_m).norm());
    std::sort(distances.begin(), distances.end());
    EXPECT_NEAR(spacings[i], distances[kSpacingNeighbours] * std::sqrt(M_PI / kSpacingNeighbours),
                1e-5);
  }
}

TEST(Spacing, OfFewPointsAndOfPointsInOnePlace) {
  EXPECT_TRUE(point_spacings_m({}).empty());
  EXPECT_THAT(point_spacings_m(Cloud(1)), ::testing::ElementsAre(0));
  Cloud two(2);
  two[1].position_m.x() = 1;
  EXPECT_NEAR(point_spacings_m(two)[0], std::sqrt(M_PI), 1e-6);
  EXPECT_THAT(point_spacings_m(Cloud(5000)), ::testing::Each(0));
}

TEST(Splats, LieFlatInTheSurface) {
  const Eigen::Vector3f normal = Eigen::Vector3f(0.6f, -0.3f, -0.7f).normalized();
  const std::array<float, 17> splat = splats_of(grid_cloud(0.01f, normal))[10 * 20 + 10];
  const Eigen::Quaternionf turn(splat[13], splat[14], splat[15], splat[16]);
  EXPECT_NEAR(turn.norm(), 1, 1e-5);
  EXPECT_GT((turn * Eigen::Vector3f::UnitZ()).dot(normal), 0.9999f);
  EXPECT_EQ(splat[10], splat[11]);
  EXPECT_NEAR(std::exp(splat[10]), kSplatSigmas * 0.01f, 0.001);
  EXPECT_NEAR(std::exp(splat[12]), 0.1f * std::exp(splat[10]), 1e-6);
  EXPECT_NEAR(0.5f + 0.28209479f * splat[6], 0, 1e-6);
  EXPECT_NEAR(0.5f + 0.28209479f * splat[7], 128.0 / 255, 1e-6);
  EXPECT_NEAR(1 / (1 + std::exp(-splat[9])), 0.95, 1e-6);
}

TEST(Splats, AreThickerWhereTheSurfaceBends) {
  Cloud cloud = grid_cloud(0.01f, {0, 0, -1});
  cloud[210].curvature_min_per_m = -100;
  const auto splats = splats_of(cloud);
  EXPECT_NEAR(std::exp(splats[210][12]), 0.5 * 100 * std::pow(std::exp(splats[210][10]), 2), 1e-6);
  EXPECT_LT(splats[211][12], splats[210][12]);
  cloud[210].curvature_max_per_m = 1e9f;
  EXPECT_EQ(splats_of(cloud)[210][12], splats[210][10]) << "no thicker than wide";
}

TEST(Splats, APointAloneIsNoWiderThanItsRadius) {
  Cloud cloud = grid_cloud(0.01f, {0, 0, -1});
  cloud[5].position_m = {30, 0, 0};
  EXPECT_NEAR(std::exp(splats_of(cloud)[5][10]), kSplatSigmas * 0.04f, 1e-5);
  cloud.resize(1);
  cloud[0].radius_m = 0;
  for (const std::size_t count : {1u, 40u})  // all in one place
    for (const auto& splat : splats_of(Cloud(count, cloud[0])))
      for (const float value : splat) EXPECT_TRUE(std::isfinite(value));
}

TEST(Splats, PointsWithoutNormalsAreRefused) {
  Cloud cloud = grid_cloud(0.01f, {0, 0, -1});
  cloud[7].normal.setZero();
  EXPECT_THAT(format_splats(cloud).error().message, HasSubstr("point 7 has no normal"));
  EXPECT_THAT(format_splats({}).error().message, HasSubstr("no point"));
}

}  // namespace
}  // namespace hermite::output
