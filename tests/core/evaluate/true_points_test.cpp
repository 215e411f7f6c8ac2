#include "core/evaluate/true_points.h"

#include <gtest/gtest.h>

#include "core/dataset/synthetic_camera.h"

namespace hermite {
namespace true_points_test {

TEST(TruePoints, APointIsWhereItsFramesHaveIt) {
  const auto sequence = or_throw(open_sequence("synthetic:scene=bare,frames=4,width=64,height=64,rate=4"));
  // The estimate's world lies elsewhere; nothing else is wrong with it.
  const Rigid3 estimate_from_true{Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized())), {1, -2, 3}};
  Trajectory estimate;
  for (const TimedPose& pose : sequence->groundtruth()) estimate.push_back({pose.timestamp_s, estimate_from_true * pose.world_from_camera});
  const auto points = or_throw(true_points(*sequence, estimate, 200, 1));
  EXPECT_GT(points.size(), 150u);
  const SyntheticRoom room(RoomScene::kBare);
  for (const TruePoint& point : points) {
    EXPECT_LT((estimate_from_true * point.true_m - point.estimated_m).norm(), 1e-9);
    EXPECT_LT(room.surface_distance(point.true_m), 0.001);
  }
  const auto others = or_throw(true_points(*sequence, estimate, 200, 2));
  EXPECT_NE(points[0].true_m, others[0].true_m);
  EXPECT_FALSE(true_points(*sequence, {}, 200, 1).ok());
}

}  // namespace true_points_test
}  // namespace hermite
