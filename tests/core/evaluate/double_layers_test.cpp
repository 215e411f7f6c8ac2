#include "core/evaluate/double_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "core/synthetic/synthetic_camera.h"

namespace hermite::evaluate {
namespace {

using Eigen::Vector3f;

constexpr float kSpacing_m = 0.004f;

// A square of 0.4 m at this height, seen from above or below, its heights disturbed by noise.
void add_plane(std::vector<LayerPoint>& cloud, float height_m, float up, float sigma_m = 0,
               float radius_m = 0.006f) {
  std::mt19937 engine(static_cast<unsigned>(cloud.size()) + 1);
  std::normal_distribution<float> noise(0, 1);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x)
      cloud.push_back({{kSpacing_m * static_cast<float>(x), kSpacing_m * static_cast<float>(y),
                        height_m + sigma_m * noise(engine)},
                       {0, 0, up},
                       radius_m});
}

std::vector<LayerPoint> planes(float height_m, float up, float sigma_m = 0) {
  std::vector<LayerPoint> cloud;
  add_plane(cloud, 0, 1, sigma_m);
  add_plane(cloud, height_m, up, sigma_m);
  return cloud;
}

std::vector<LayerPoint> moved(std::vector<LayerPoint> cloud, const Eigen::Matrix3f& rotation,
                              const Vector3f& translation) {
  for (LayerPoint& point : cloud) {
    point.position_m = rotation * point.position_m + translation;
    point.normal = rotation * point.normal;
  }
  return cloud;
}

TEST(DoubleLayers, OneLayerIsNone) {
  std::vector<LayerPoint> cloud;
  add_plane(cloud, 0, 1);
  const DoubleLayers layers = double_layers(cloud);
  EXPECT_EQ(layers.point_count, 10'000);
  EXPECT_EQ(layers.doubled_count, 0);
  EXPECT_EQ(layers.share, 0);
}

TEST(DoubleLayers, TwoLayersTwoCentimetresApartAreAll) {
  EXPECT_EQ(double_layers(planes(0.02f, 1)).share, 1);
  EXPECT_EQ(double_layers(planes(-0.012f, 1)).share, 1);
  EXPECT_EQ(double_layers(planes(0.029f, 1)).share, 1);
}

TEST(DoubleLayers, NearerIsNoiseAndFartherIsAnotherThing) {
  EXPECT_EQ(double_layers(planes(0.05f, 1)).doubled_count, 0);
  EXPECT_EQ(double_layers(planes(0.008f, 1)).doubled_count, 0);
}

TEST(DoubleLayers, TheTwoSidesOfAPanelAreNone) {
  EXPECT_EQ(double_layers(planes(0.02f, -1)).doubled_count, 0);
}

TEST(DoubleLayers, NoiseOfThreeMillimetresMakesNoLayer) {
  std::vector<LayerPoint> cloud;
  add_plane(cloud, 0, 1, 0.003f);
  // 10 mm are 3.3 deviations: one point in a thousand, and two of the seven beside a point must lie
  // there.
  EXPECT_LT(double_layers(cloud).share, 0.002);
  EXPECT_GT(double_layers(planes(0.02f, 1, 0.003f)).share, 0.95) << "and hides none";
}

TEST(DoubleLayers, WherePlacedAndTurnedDoesNotMatter) {
  const Eigen::Matrix3f rotation =
      Eigen::AngleAxisf(0.7f, Vector3f(1, 2, -0.5f).normalized()).toRotationMatrix();
  EXPECT_EQ(double_layers(moved(planes(0.02f, 1), rotation, {-3.1f, 2.2f, -0.7f})).share, 1);
  EXPECT_EQ(double_layers(moved(planes(0.05f, 1), rotation, {-3.1f, 2.2f, -0.7f})).doubled_count,
            0);
}

TEST(DoubleLayers, OnlyWhereTheLayersOverlap) {
  std::vector<LayerPoint> cloud;
  add_plane(cloud, 0, 1);
  const std::size_t first = cloud.size();
  add_plane(cloud, 0.02f, 1);
  for (std::size_t i = first; i < cloud.size(); ++i) cloud[i].position_m.x() += 0.2f;
  EXPECT_NEAR(double_layers(cloud).share, 0.5, 0.02) << "and within a radius of the edges";
}

// As from book to book on a shelf: true surfaces, one behind the other, but beside each other.
TEST(DoubleLayers, AStepCountsAlongItsEdgeOnly) {
  std::vector<LayerPoint> cloud;
  add_plane(cloud, 0, 1);
  for (LayerPoint& point : cloud)
    if (point.position_m.x() > 0.199f) point.position_m.z() += 0.02f;
  EXPECT_LT(double_layers(cloud).share, 4 * 0.006 / 0.4) << "two radii on either side";
}

TEST(DoubleLayers, WithoutRadiiAndWithHugeOnesTheReachIsBounded) {
  std::vector<LayerPoint> cloud;
  add_plane(cloud, 0, 1, 0, 0);
  add_plane(cloud, 0.02f, 1, 0, 0);
  EXPECT_EQ(double_layers(cloud).share, 1);
  for (LayerPoint& point : cloud) point.radius_m = 1;
  EXPECT_EQ(double_layers(cloud).share, 1);
  // 20 mm beside each other: no disc of at most 10 mm covers the other.
  const std::vector<LayerPoint> apart{{{0, 0, 0}, {0, 0, 1}, 1}, {{0.02f, 0, 0.02f}, {0, 0, 1}, 1}};
  EXPECT_EQ(double_layers(apart).doubled_count, 0);
}

TEST(DoubleLayers, NonsenseIsLeftOut) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<LayerPoint> cloud{
      {{0, 0, 0}, {0, 0, 5}, kNan},      {{0, 0, 0.02f}, {0, 0, 0.1f}, -1},
      {{kNan, 0, 0}, {0, 0, 1}, 0.01f},  {{0, 0, 0}, {0, kNan, 1}, 0.01f},
      {{0, 0, 0}, {0, 0, 0}, 0.01f},     {{0, kInfinity, 0}, {0, 0, 1}, 0.01f},
      {{0, 0, 1e30f}, {0, 0, 1}, 0.01f}, {{0, 0, 0}, {0, 0, 1e30f}, 0.01f}};
  const DoubleLayers layers = double_layers(cloud);
  EXPECT_EQ(layers.point_count, 2);
  EXPECT_EQ(layers.left_out_count, 6);
  EXPECT_EQ(layers.doubled_count, 2)
      << "a length of the normal means nothing, nor does a radius that is none";
  EXPECT_EQ(double_layers({}).share, 0);
}

// The floor of the measure: what a surface without any error counts. Steps of furniture are true.
TEST(DoubleLayers, TheTrueSurfaceOfTheFurnishedRoomHasFew) {
  const synthetic::SyntheticRoom room(synthetic::RoomScene::kRoom);
  const Camera camera{240, 180, 196.875, 196.875, 119.5, 89.5, 5000};
  std::vector<LayerPoint> cloud;
  for (const double time_s : {0.0, 2.5, 5.0, 7.5}) {
    const Rigid3 world_from_camera = synthetic::synthetic_pose(time_s, 1);
    const DepthImage depth = room.render(camera, world_from_camera).depth;
    const auto at = [&](int x, int y) { return camera.unproject(x, y, depth.at(x, y) / 5000.0); };
    for (int y = 0; y + 1 < camera.height; ++y)
      for (int x = 0; x + 1 < camera.width; ++x) {
        const Eigen::Vector3d here = at(x, y),
                              normal = (at(x, y + 1) - here).cross(at(x + 1, y) - here);
        const double spacing_m = here.z() / camera.fx;
        // Beyond four spacings to the next pixel there is an edge between, and the normal means
        // nothing.
        if ((at(x + 1, y) - here).norm() > 4 * spacing_m ||
            (at(x, y + 1) - here).norm() > 4 * spacing_m)
          continue;
        cloud.push_back({(world_from_camera * here).cast<float>(),
                         (world_from_camera.rotation * normal.normalized()).cast<float>(),
                         static_cast<float>(spacing_m)});
      }
  }
  const DoubleLayers layers = double_layers(cloud);
  EXPECT_GT(layers.point_count, 150'000);
  EXPECT_LT(layers.share, 0.005) << "measured: 0.0006";
}

TEST(DoubleLayers, JsonHasItsKeys) {
  const auto json = nlohmann::json::parse(format_double_layers_json({200, 3, 50, 0.25}));
  EXPECT_EQ(json.at("layer_points"), 200);
  EXPECT_EQ(json.at("layer_left_out"), 3);
  EXPECT_EQ(json.at("layer_doubled"), 50);
  EXPECT_EQ(json.at("layer_doubled_share"), 0.25);
}

}  // namespace
}  // namespace hermite::evaluate
