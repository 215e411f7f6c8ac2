#include "core/evaluate/true_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/source/open_sequence.h"
#include "core/synthetic/synthetic_camera.h"

namespace hermite::evaluate {
namespace true_points_test {

const Rigid3 kEstimateFromTrue{
    Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized())), {1, -2, 3}};

// The estimate's world lies elsewhere; nothing else is wrong with it.
TruePlaces surface_of(const dataset::Sequence& sequence) {
  dataset::Trajectory estimate;
  for (const dataset::TimedPose& pose : sequence.groundtruth())
    estimate.push_back({pose.timestamp_s, kEstimateFromTrue * pose.world_from_camera});
  return or_throw(TruePlaces::of(sequence, estimate));
}

TEST(TruePlaces, APointIsWhereItsFramesHaveIt) {
  const auto sequence =
      or_throw(source::open_sequence("synthetic:scene=bare,frames=4,width=64,height=64,rate=4"));
  const TruePlaces surface = surface_of(*sequence);
  const auto points = surface.points(200, 1);
  EXPECT_GT(points.size(), 150u);
  const synthetic::SyntheticRoom room(synthetic::RoomScene::kBare);
  for (const TruePoint& point : points) {
    EXPECT_LT((kEstimateFromTrue * point.true_m - point.estimated_m).norm(), 1e-9);
    EXPECT_LT(room.surface_distance(point.true_m), 0.001);
  }
  EXPECT_NE(points[0].true_m, surface.points(200, 2)[0].true_m);
  EXPECT_FALSE(TruePlaces::of(*sequence, {}).ok());
}

TEST(TruePlaces, WallsOfABareRoomArePlanesAlongItsAxes) {
  const auto sequence =
      or_throw(source::open_sequence("synthetic:scene=bare,frames=4,width=64,height=64,rate=4"));
  const TruePlaces surface = surface_of(*sequence);
  EXPECT_LT(surface.estimate_from_true().angularDistance(kEstimateFromTrue.rotation), 1e-6);
  EXPECT_EQ(surface.true_up().cwiseAbs().sum(), 1);
  int planes = 0;
  for (const TruePoint& point : surface.points(40, 1)) {
    const std::optional<TruePlane> plane = surface.plane_at(point.pixel);
    if (!plane) continue;
    ++planes;
    EXPECT_GT(plane->normal.cwiseAbs().maxCoeff(), 0.99999);
    EXPECT_LT(std::abs(plane->normal.dot(point.true_m - plane->centre_m)), 0.001);
  }
  EXPECT_GT(planes, 20);
}

}  // namespace true_points_test
}  // namespace hermite::evaluate
