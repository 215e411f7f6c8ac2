#include "core/compare/sight.h"

#include <gtest/gtest.h>

#include "tests/core/compare/made_corner.h"

namespace hermite::compare::sight_test {

using Eigen::Vector3d;

TEST(Sight, TellsEmptyFromNeverSeen) {
  const ComparedScan scan = test::corner_scan(test::usual_boxes());
  const Sight sight(scan);
  EXPECT_GT(sight.view_count(), 3u);
  EXPECT_TRUE(sight.looked_through({0.55, 0.45, 0.2}, 0.03)) << "above the floor between the boxes";
  EXPECT_FALSE(sight.looked_through({0.27, 0.2, 0.1}, 0.03)) << "within a box";
  EXPECT_FALSE(sight.looked_through({0.55, 0.45, -0.1}, 0.03)) << "below the floor";
  EXPECT_FALSE(sight.looked_through({0.55, 0.45, 0.01}, 0.03))
      << "nearer to the floor than the margin";
  EXPECT_FALSE(sight.looked_through({5, 5, 1}, 0.03)) << "behind the camera";
}

TEST(Sight, WithoutAPathNothingWasLookedThrough) {
  const ComparedScan scan =
      or_throw(ComparedScan::create(test::corner_cloud(test::usual_boxes()), {}, "scan"));
  EXPECT_EQ(Sight(scan).view_count(), 0u);
  EXPECT_FALSE(Sight(scan).looked_through({0.55, 0.45, 0.2}, 0.03));
}

TEST(Sight, ALongPathHasABoundedNumberOfViews) {
  dataset::Trajectory path;
  for (int i = 0; i < 300; ++i)
    path.push_back({0.1 * i, {Eigen::Quaterniond::Identity(), Vector3d(0.5 * i, 0, 0)}});
  const ComparedScan scan =
      or_throw(ComparedScan::create(test::corner_cloud({}, 1, 0.03), path, "scan"));
  EXPECT_EQ(Sight(scan).view_count(), Sight::kMostViews);
}

}  // namespace hermite::compare::sight_test
