#include "core/output/mean_normals.h"

#include <gtest/gtest.h>

namespace hermite::output {
namespace {

TEST(MeanNormals, AreByAreaAndNoneWhereThereIsNoTriangle) {
  // A large triangle in the plane z = 0 and a small one at right angles to it share an edge.
  const std::vector<Eigen::Vector3f> positions{
      {0, 0, 0}, {1, 0, 0}, {0, 9, 0}, {0, 0, -3}, {5, 5, 5}};
  const auto normals = mean_normals(positions, {{0, 1, 2}, {1, 0, 3}});
  EXPECT_EQ(normals[2], Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(normals[3], Eigen::Vector3f(0, -1, 0));
  EXPECT_LT((normals[0] - Eigen::Vector3f(0, -3, 9).normalized()).norm(), 1e-6f);
  EXPECT_EQ(normals[4], Eigen::Vector3f::Zero());
}

}  // namespace
}  // namespace hermite::output
