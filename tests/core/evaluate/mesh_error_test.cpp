#include "core/evaluate/mesh_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/evaluate/true_surface.h"

namespace hermite::evaluate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kRadius_m = 0.5;
constexpr std::size_t kFewPoints = 20'000;

// By longitude and latitude, of which each quarter turn has `steps`.
std::vector<Triangle> sphere_triangles(double radius_m, int steps) {
  const auto point = [&](int i, int k) -> Vector3f {
    const double longitude = i * M_PI / 2 / steps, latitude = k * M_PI / 2 / steps;
    return (radius_m * Vector3d(std::cos(latitude) * std::cos(longitude),
                                std::cos(latitude) * std::sin(longitude), std::sin(latitude)))
        .cast<float>();
  };
  std::vector<Triangle> triangles;
  for (int i = 0; i < 4 * steps; ++i)
    for (int k = -steps; k < steps; ++k) {
      triangles.push_back({point(i, k), point(i + 1, k), point(i + 1, k + 1)});
      triangles.push_back({point(i, k), point(i + 1, k + 1), point(i, k + 1)});
    }
  return triangles;
}

// A sphere with a crease on its upper half, seen once from x = 2.
SeenTruth sphere_truth() {
  SeenTruth truth;
  truth.distance_m = [](const Vector3d& point) {
    return std::min(std::abs(point.norm() - kRadius_m), kSurfaceReach_m);
  };
  for (const Triangle& triangle : sphere_triangles(kRadius_m, 60))
    truth.samples.push_back(triangle[0].cast<double>());
  truth.creases = {Vector3d(1, 0, 1).normalized() * kRadius_m};
  truth.view_camera = {64, 64, 60, 60, 31.5, 31.5, 1000};
  BesideView view;
  view.world_from_camera = {Eigen::Quaterniond(Eigen::AngleAxisd(-M_PI / 2, Vector3d::UnitY())),
                            {2, 0, 0}};
  view.depth_m = Image<float>(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const Vector3d ray((x - 31.5) / 60, (y - 31.5) / 60, 1), centre(0, 0, 2);
      const double a = ray.dot(ray), b = ray.dot(centre),
                   c = centre.dot(centre) - kRadius_m * kRadius_m, root = b * b - a * c;
      if (root > 0.02) view.depth_m.at(x, y) = static_cast<float>((b - std::sqrt(root)) / a);
    }
  truth.views.push_back(view);
  return truth;
}

TEST(PointsOn, GoByAreaEvenly) {
  const std::vector<Triangle> triangles{{Vector3f(0, 0, 0), Vector3f(1, 0, 0), Vector3f(0, 1, 0)},
                                        {Vector3f(0, 0, 5), Vector3f(0, 0, 5), Vector3f(1, 0, 5)},
                                        {Vector3f(0, 0, 1), Vector3f(3, 0, 1), Vector3f(0, 1, 1)}};
  const std::vector<Vector3d> points = points_on(triangles, 4000);
  ASSERT_EQ(points.size(), 4000u);
  Vector3d sum_low = Vector3d::Zero(), sum_high = Vector3d::Zero();
  int low = 0;
  for (const Vector3d& point : points) {
    ASSERT_TRUE(point.z() == 0 || point.z() == 1) << "the triangle without area has no point";
    ASSERT_LE(point.x() / (point.z() == 0 ? 1 : 3) + point.y(), 1 + 1e-6);
    (point.z() == 0 ? sum_low : sum_high) += point;
    low += point.z() == 0 ? 1 : 0;
  }
  EXPECT_EQ(low, 1000);
  EXPECT_LT((sum_low / 1000 - Vector3d(1.0 / 3, 1.0 / 3, 0)).norm(), 0.005);
  EXPECT_LT((sum_high / 3000 - Vector3d(1, 1.0 / 3, 1)).norm(), 0.01);
  EXPECT_TRUE(points_on({}, 10).empty());
}

TEST(MeshError, OfTheTrueSphereIsSmallAndItIsWhole) {
  const Result<MeshError> error =
      mesh_error(sphere_triangles(kRadius_m, 60), sphere_truth(), kFewPoints);
  ASSERT_TRUE(error.ok()) << error.error().message;
  EXPECT_LT(error->surface.max_m, 2e-4) << "chords of 1.5 degrees";
  EXPECT_EQ(error->at_5mm.precision, 1);
  EXPECT_EQ(error->at_5mm.recall, 1);
  EXPECT_EQ(error->at_10mm.f(), 1);
  EXPECT_EQ(error->missing_at_creases, 0);
  EXPECT_LT(error->depth_mean_m, 5e-4);
  EXPECT_EQ(error->depth_missing, 0);
  EXPECT_EQ(error->views, 1);
}

TEST(MeshError, OfASphereThatIsTooLargeIsByHowMuch) {
  const Result<MeshError> error =
      mesh_error(sphere_triangles(kRadius_m + 0.007, 60), sphere_truth(), kFewPoints);
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->surface.mean_m, 0.007, 2e-4);
  EXPECT_NEAR(error->surface.percentile95_m, 0.007, 2e-4);
  ASSERT_TRUE(error->creases.has_value());
  EXPECT_NEAR(error->creases->mean_m, 0.007, 2e-4);
  EXPECT_EQ(error->at_5mm.precision, 0);
  EXPECT_EQ(error->at_5mm.recall, 0);
  EXPECT_EQ(error->at_5mm.f(), 0);
  EXPECT_EQ(error->at_10mm.f(), 1);
  EXPECT_GT(error->depth_mean_m, 0.007);
  EXPECT_LT(error->depth_mean_m, 0.014) << "more than the radius where the sphere is slanted";
}

TEST(MeshError, WhatIsMissingShowsInRecallCreasesAndDepth) {
  std::vector<Triangle> lower;
  for (const Triangle& triangle : sphere_triangles(kRadius_m, 60))
    if (triangle[0].z() < 1e-4f && triangle[1].z() < 1e-4f && triangle[2].z() < 1e-4f)
      lower.push_back(triangle);
  const Result<MeshError> error = mesh_error(lower, sphere_truth(), kFewPoints);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->at_10mm.precision, 1);
  EXPECT_NEAR(error->at_10mm.recall, 0.5, 0.03);
  EXPECT_EQ(error->missing_at_creases, 1);
  EXPECT_FALSE(error->creases.has_value());
  EXPECT_NEAR(error->depth_missing, 0.5, 0.02);
}

TEST(MeshError, OfAThingThatFloatsIsCapped) {
  std::vector<Triangle> triangles = sphere_triangles(kRadius_m, 60);
  triangles.push_back({Vector3f(4, 0, 0), Vector3f(6, 0, 0), Vector3f(4, 2, 0)});
  const Result<MeshError> error = mesh_error(triangles, sphere_truth(), kFewPoints);
  ASSERT_TRUE(error.ok());
  const double share = 2 / (2 + M_PI);
  EXPECT_NEAR(error->surface.mean_m, kSurfaceReach_m * share, 1e-3);
  EXPECT_NEAR(error->at_10mm.precision, 1 - share, 0.01);
  EXPECT_EQ(error->at_10mm.recall, 1);
}

TEST(MeshError, OfACloudIsOfItsPointsAndDrawsNoDepth) {
  std::vector<Triangle> dots;
  for (const Vector3d& sample : sphere_truth().samples) {
    const Vector3f dot = (sample * (kRadius_m - 0.003) / kRadius_m).cast<float>();
    dots.push_back({dot, dot, dot});
  }
  const Result<MeshError> error = mesh_error(dots, sphere_truth(), kFewPoints);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->surface.point_count, static_cast<std::int64_t>(dots.size()));
  EXPECT_NEAR(error->surface.mean_m, 0.003, 1e-5);
  EXPECT_EQ(error->at_5mm.f(), 1);
  EXPECT_EQ(error->views, 0);
  EXPECT_EQ(nlohmann::json::parse(format_mesh_error_json(*error))["f_score_5mm"], 1.0);
}

TEST(MeshError, OfNothingOrOfNoNumbersIsAnError) {
  EXPECT_EQ(mesh_error({}, sphere_truth(), kFewPoints).error().code, ErrorCode::kInvalidArgument);
  const Vector3f nan = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(mesh_error({{nan, nan, nan}}, sphere_truth(), kFewPoints).error().code,
            ErrorCode::kInvalidArgument);
  std::vector<Triangle> triangles = sphere_triangles(kRadius_m, 30);
  triangles.push_back({nan, Vector3f(0, 0, 0), Vector3f(1, 0, 0)});
  const Result<MeshError> error = mesh_error(triangles, sphere_truth(), kFewPoints);
  ASSERT_TRUE(error.ok()) << "triangles that are no numbers are left out";
  EXPECT_LT(error->surface.max_m, 1e-3);
}

}  // namespace
}  // namespace hermite::evaluate
