#include "core/compare/sample_grid.h"

#include <gtest/gtest.h>

#include <vector>

namespace hermite::compare::sample_grid_test {

using Eigen::Vector3d;

TEST(SampleGrid, FindsTheNearestThatFacesTheSameWay) {
  std::vector<SurfaceSample> samples(3);
  samples[0].position_m = {0.1, 0, 0};
  samples[1].position_m = {0.03, 0, 0};
  samples[2].position_m = {0.01, 0, 0};
  samples[0].normal = samples[1].normal = Vector3d::UnitZ();
  samples[2].normal = -Vector3d::UnitZ();
  const SampleGrid grid(samples, 0.05);
  EXPECT_EQ(grid.nearest(Vector3d::Zero(), Vector3d::UnitZ(), 0.2, 0.5), 1u);
  EXPECT_EQ(grid.nearest(Vector3d::Zero(), -Vector3d::UnitZ(), 0.2, 0.5), 2u);
  EXPECT_EQ(grid.nearest(Vector3d::Zero(), Vector3d::UnitZ(), 0.02, 0.5), std::nullopt);
  std::vector<std::uint32_t> found;
  grid.for_each_within(Vector3d::Zero(), 0.05, [&](std::uint32_t i) { found.push_back(i); });
  EXPECT_EQ(found.size(), 2u);
}

}  // namespace hermite::compare::sample_grid_test
