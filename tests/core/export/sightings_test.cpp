#include "core/export/sightings.h"

#include <gtest/gtest.h>

namespace hermite::exports {
namespace {

Camera wall_camera() {
  Camera camera;
  camera.width = camera.height = 100;
  camera.fx = camera.fy = 100;
  camera.cx = camera.cy = 49.5;
  return camera;
}

DepthImage wall_at(double depth_m) {
  DepthImage depth(100, 100);
  depth.pixels.assign(depth.pixels.size(), static_cast<std::uint16_t>(1000 * depth_m));
  return depth;
}

// One point 2 m ahead that looks at the camera.
output::Cloud point_ahead() {
  output::Cloud cloud(1);
  cloud[0].position_m = {0.1f, 0, 2};
  cloud[0].normal = {0, 0, -1};
  return cloud;
}

std::size_t sightings_of(const output::Cloud& cloud, const DepthImage& depth,
                         const Rigid3& world_from_camera = {}) {
  Sightings sightings(cloud);
  sightings.look(wall_camera(), world_from_camera, depth);
  return sightings.tracks()[0].size();
}

TEST(Sightings, AreWhereThePointProjects) {
  const output::Cloud cloud = point_ahead();
  Sightings sightings(cloud);
  sightings.look(wall_camera(), {}, wall_at(1));
  sightings.look(wall_camera(), {}, wall_at(2.03));
  const auto tracks = sightings.tracks();
  ASSERT_EQ(tracks[0].size(), 1u);
  EXPECT_EQ(tracks[0][0].image, 1u);
  EXPECT_NEAR(tracks[0][0].u_px, 54.5, 1e-4);
  EXPECT_NEAR(tracks[0][0].v_px, 49.5, 1e-4);
}

TEST(Sightings, AreNotOfWhatIsHiddenOutsideBehindOrTurnedAway) {
  output::Cloud cloud = point_ahead();
  EXPECT_EQ(sightings_of(cloud, wall_at(2)), 1u);
  EXPECT_EQ(sightings_of(cloud, wall_at(1.9)), 0u) << "hidden";
  EXPECT_EQ(sightings_of(cloud, wall_at(0)), 0u) << "not measured";
  EXPECT_EQ(sightings_of(cloud, wall_at(2), {Eigen::Quaterniond::Identity(), {2, 0, 0}}), 0u)
      << "outside";
  EXPECT_EQ(sightings_of(cloud, wall_at(2), {Eigen::Quaterniond::Identity(), {0, 0, 4}}), 0u)
      << "behind";
  cloud[0].normal = {0, 0, 1};
  EXPECT_EQ(sightings_of(cloud, wall_at(2)), 0u) << "turned away";
}

TEST(Sightings, OfManyAFewStaySpreadOverAll) {
  const output::Cloud cloud = point_ahead();
  Sightings sightings(cloud);
  for (int i = 0; i < 1000; ++i) sightings.look(wall_camera(), {}, wall_at(2));
  const auto tracks = sightings.tracks();
  EXPECT_LE(tracks[0].size(), Sightings::kMostSightings);
  EXPECT_GE(tracks[0].size(), Sightings::kMostSightings / 2);
  EXPECT_GT(tracks[0].back().image, 700u);
}

}  // namespace
}  // namespace hermite::exports
