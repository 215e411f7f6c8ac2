#include "core/output/thin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace hermite::output {
namespace {

// A square metre of 100 x 100 points, the confidence of each its place.
Cloud square_metre() {
  Cloud cloud(10'000);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i].position_m = {0.01f * static_cast<float>(i % 100), 0.01f * static_cast<float>(i / 100),
                           -3};
    cloud[i].confidence = static_cast<float>(i);
  }
  return cloud;
}

TEST(Thinned, LeavesSoFewSpreadEvenly) {
  const Cloud thin = thinned(square_metre(), 500);
  EXPECT_LE(thin.size(), 500u);
  EXPECT_GT(thin.size(), 250u);
  EXPECT_TRUE(std::is_sorted(thin.begin(), thin.end(), [](auto& a, auto& b) {
    return a.confidence < b.confidence;
  })) << "in their order";
  float farthest = 0;
  for (const CloudPoint& point : square_metre()) {
    float nearest = std::numeric_limits<float>::infinity();
    for (const CloudPoint& kept : thin)
      nearest = std::min(nearest, (kept.position_m - point.position_m).norm());
    farthest = std::max(farthest, nearest);
  }
  EXPECT_LT(farthest, 0.1f);
}

TEST(Thinned, KeepsTheMostConfidentOfACube) {
  Cloud cloud(3);
  cloud[1].confidence = 2;
  cloud[2].confidence = 1;
  const Cloud thin = thinned(cloud, 1);
  ASSERT_EQ(thin.size(), 1u);
  cloud[0].position_m = {-1, -1, -1};
  cloud[1].position_m = cloud[2].position_m = {1, 1, 1};
  EXPECT_EQ(thinned(cloud, 2)[1].confidence, 2);
}

TEST(Thinned, LeavesASmallCloudAsItIs) {
  EXPECT_EQ(thinned(square_metre(), 10'000).size(), 10'000u);
  EXPECT_TRUE(thinned({}, 1).empty());
}

TEST(Thinned, OnePointOfCornersAroundTheOrigin) {
  Cloud cloud(8);
  for (int i = 0; i < 8; ++i)
    cloud[static_cast<std::size_t>(i)].position_m = {i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f,
                                                     i & 4 ? 1e6f : -1e6f};
  EXPECT_EQ(thinned(cloud, 1).size(), 1u);
}

}  // namespace
}  // namespace hermite::output
