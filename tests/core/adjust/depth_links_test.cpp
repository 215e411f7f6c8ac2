#include "core/adjust/depth_links.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "core/adjust/bundle_residuals.h"
#include "core/disturb/depth_noise.h"
#include "tests/core/adjust/plane_world.h"

namespace hermite::adjust {
namespace {

// Two walls and the floor of a room; y is down. One wall is before the camera.
const PlaneRoom kCorner{{0.2, 0, 0.4}, {-0.7, 0, 0.3}, {0, 1.6, 0}};
const PlaneRoom kWall{{0, 0, 0.5}};

Rigid3 moved(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d twist;
  twist << x, y, z, rx, ry, rz;
  return exp_se3(twist);
}

// They look down a little.
const std::vector<Rigid3> kCameras{moved(0, 0, 0, -0.3, 0, 0),
                                   moved(0.3, -0.1, 0.1, -0.25, 0.15, 0.02),
                                   moved(-0.2, 0.1, 0.2, -0.4, 0.1, 0)};

// A submap with a keyframe for each camera, all where they truly are. Seed 0: no noise.
SparseMap map_of(const PlaneRoom& room, const std::vector<Rigid3>& world_from_camera,
                 std::uint64_t seed) {
  SparseMap map;
  map.camera = kPlaneCamera;
  const Rigid3 submap_from_camera = moved(0.05, 0.02, -0.03, 0.1, 0, 0.05);
  for (std::size_t i = 0; i < world_from_camera.size(); ++i) {
    const DepthImage depth = depth_of(seen_from(room, world_from_camera[i]), kPlaneCamera);
    const disturb::NoiseOptions noise{
        .model = seed > 0 ? disturb::NoiseModel::kKinectWhite : disturb::NoiseModel::kNone,
        .seed = seed};
    Keyframe keyframe;
    keyframe.submap = static_cast<std::uint32_t>(i);
    keyframe.submap_from_camera = submap_from_camera;
    keyframe.planes = fit_depth_planes(
        disturb::add_noise(depth, kPlaneCamera, noise, static_cast<std::int64_t>(i)), kPlaneCamera);
    map.keyframes.push_back(std::move(keyframe));
    map.world_from_submap.push_back(world_from_camera[i] * inverse(submap_from_camera));
  }
  return map;
}

// How far the link's pose is from where the submaps stand: metres, then radians.
Vector6d off(const BundleLink& link, const SparseMap& map) {
  return link_residual(link.from_from_to, map.world_from_submap[link.from],
                       map.world_from_submap[link.to], nullptr);
}

Vector6d eigenvalues_of(const Matrix6d& information) {
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(information).eigenvalues();
}

TEST(DepthLinks, TwoViewsOfACornerSayHowTheyLieToEachOther) {
  for (const std::uint64_t seed : {0u, 1u, 2u}) {
    const SparseMap truth = map_of(kCorner, {kCameras[0], kCameras[1]}, seed);
    SparseMap map = truth;
    map.world_from_submap[1] =
        map.world_from_submap[1] * moved(0.01, -0.008, 0.006, 0.004, -0.006, 0.005);
    for (int round = 0; round < 3; ++round) {
      const std::vector<BundleLink> links = depth_links(map, {0, 1});
      ASSERT_EQ(links.size(), 1u);
      EXPECT_EQ(links[0].from, 0u);
      EXPECT_EQ(links[0].to, 1u);
      EXPECT_FALSE(links[0].robust);
      map.world_from_submap[1] = map.world_from_submap[0] * links[0].from_from_to;
    }
    const Vector6d error = log_se3(inverse(truth.world_from_submap[1]) * map.world_from_submap[1]);
    EXPECT_LT(error.head<3>().norm(), seed == 0 ? 0.0002 : 0.001) << seed;
    EXPECT_LT(error.tail<3>().norm(), seed == 0 ? 0.0002 : 0.001) << seed;
  }
}

// What noise does to a link has no direction: with the distances' own normals as derivatives it
// has.
TEST(DepthLinks, NoiseDoesNotPullSideways) {
  Vector6d mean = Vector6d::Zero(), square = Vector6d::Zero();
  constexpr int kSeeds = 12;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SparseMap map = map_of(kCorner, {kCameras[0], kCameras[1]}, seed);
    const std::vector<BundleLink> links = depth_links(map, {0, 1});
    ASSERT_EQ(links.size(), 1u);
    const Vector6d error = off(links[0], map);
    mean += error / kSeeds;
    square += error.cwiseProduct(error) / kSeeds;
  }
  const Vector6d deviation = (square - mean.cwiseProduct(mean)).cwiseSqrt();
  for (int i = 0; i < 6; ++i)
    EXPECT_LT(std::abs(mean[i]), 4 * deviation[i] / std::sqrt(kSeeds) + 0.0001)
        << i << ": " << deviation[i];
  EXPECT_LT(mean.head<3>().norm(), 0.0005);
  EXPECT_LT(mean.tail<3>().norm(), 0.0003);
}

TEST(DepthLinks, AlongAWallDepthSaysNothing) {
  SparseMap map = map_of(kWall, {kCameras[0], kCameras[1]}, 0);
  const Rigid3 along = moved(0.01, 0.02, 0, 0, 0, 0), across = moved(0, 0, 0.01, 0, 0, 0);
  map.world_from_submap[1] = along * across * map.world_from_submap[1];
  const std::vector<BundleLink> links = depth_links(map, {0, 1});
  ASSERT_EQ(links.size(), 1u);
  const Vector6d eigenvalues = eigenvalues_of(links[0].information);
  EXPECT_LT(eigenvalues[2], 1e-4 * eigenvalues[3])
      << "two ways along the wall, and a turn about its normal";
  const Rigid3 world_from_linked = map.world_from_submap[0] * links[0].from_from_to;
  const Eigen::Vector3d step_m =
      world_from_linked.translation - map.world_from_submap[1].translation;
  EXPECT_NEAR(step_m.z(), -0.01, 0.0005);
  EXPECT_LT(step_m.head<2>().norm(), 0.0005);
}

TEST(DepthLinks, OnlyWhatOverlapsIsLinked) {
  const Rigid3 turned = moved(0, 0, 0, 0, 1.2, 0), beside = moved(-3, 0, 0, 0, 0, 0);
  EXPECT_TRUE(depth_links(map_of(kWall, {kCameras[0], turned}, 0), {0, 1}).empty());
  EXPECT_TRUE(depth_links(map_of(kWall, {kCameras[0], beside}, 0), {0, 1}).empty());
  SparseMap map = map_of(kCorner, kCameras, 0);
  EXPECT_EQ(depth_links(map, {0, 1, 2}).size(), 3u);
  const std::vector<BundleLink> of_two = depth_links(map, {2, 1});
  ASSERT_EQ(of_two.size(), 1u);
  EXPECT_EQ(of_two[0].from, 1u) << "places in the list: submap 1";
  EXPECT_EQ(of_two[0].to, 0u);
  map.keyframes[1].planes.clear();
  EXPECT_EQ(depth_links(map, {0, 1, 2}).size(), 1u);
  map.keyframes[2].submap = 0;
  EXPECT_TRUE(depth_links(map, {0, 1, 2}).empty()) << "keyframes of one submap stand still in it";
}

// A wall 10 cm behind another is another wall.
TEST(DepthLinks, SurfacesThatDoNotMeetAreNotTakenForOne) {
  SparseMap map = map_of(kWall, {kCameras[0], kCameras[1]}, 0);
  map.world_from_submap[1] = moved(0, 0, 0.1, 0, 0, 0) * map.world_from_submap[1];
  EXPECT_TRUE(depth_links(map, {0, 1}).empty());
}

TEST(DepthLinks, WhatContradictsTheLayoutSaysLess) {
  SparseMap map = map_of(kCorner, kCameras, 0);
  const Matrix6d sure = depth_links(map, {0, 1, 2})[0].information;
  map.world_from_submap[2] = map.world_from_submap[2] * moved(0.01, 0.01, 0.01, 0, 0, 0);
  const Matrix6d unsure = depth_links(map, {0, 1, 2})[0].information;
  EXPECT_LT(unsure.norm(), 0.1 * sure.norm()) << "that of the two others, too";
}

// As a damaged checkpoint may have them.
TEST(DepthLinks, PlanesThatAreNoneDoNoHarm) {
  const SparseMap map = map_of(kCorner, {kCameras[0], kCameras[1]}, 0);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInfinity = std::numeric_limits<float>::infinity();
  for (const float value : {kNan, kInfinity, -kInfinity, 1e38f, 1e-38f, -1.0f})
    for (const std::size_t damaged : {0u, 1u}) {
      SparseMap other = map;
      for (std::size_t i = 0; i < other.keyframes[damaged].planes.size(); ++i)
        other.keyframes[damaged].planes[i][i % 3] = value;
      for (const BundleLink& link : depth_links(other, {0, 1})) {
        EXPECT_TRUE(is_finite(link.from_from_to)) << value;
        EXPECT_TRUE(link.information.allFinite()) << value;
      }
    }
}

}  // namespace
}  // namespace hermite::adjust
