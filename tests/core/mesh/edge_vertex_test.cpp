#include "core/mesh/edge_vertex.h"

#include <gtest/gtest.h>

#include <array>

namespace hermite::mesh {
namespace {

const Eigen::Vector3f kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

TEST(EdgeVertex, LiesOnAPlaneInTheMiddleOfItsPoints) {
  const std::array<SurfacePlane, 2> planes = {{{{0, 0, 1}, kZ}, {{2, 0, 1}, kZ}}};
  const EdgeVertex vertex = meet(planes);
  EXPECT_EQ(vertex.rank, 1);
  EXPECT_TRUE(vertex.position_m.isApprox(Eigen::Vector3f(1, 0, 1), 1e-6f));
}

TEST(EdgeVertex, LiesOnTheEdgeOfTwoPlanes) {
  const std::array<SurfacePlane, 4> planes = {
      {{{0, 0.5f, 0}, kX}, {{0, 0.5f, 1}, kX}, {{0.5f, 0, 0}, kY}, {{0.5f, 0, 1}, kY}}};
  const EdgeVertex vertex = meet(planes);
  EXPECT_EQ(vertex.rank, 2);
  EXPECT_TRUE(vertex.position_m.isApprox(Eigen::Vector3f(0, 0, 0.5f), 1e-6f));
}

TEST(EdgeVertex, LiesInTheCornerOfThree) {
  const std::array<SurfacePlane, 3> planes = {{{{1, 5, 6}, kX}, {{7, 2, 8}, kY}, {{9, 4, 3}, kZ}}};
  const EdgeVertex vertex = meet(planes);
  EXPECT_EQ(vertex.rank, 3);
  EXPECT_TRUE(vertex.position_m.isApprox(Eigen::Vector3f(1, 2, 3), 1e-5f));
}

// Five degrees of noise on a wall are no edge, which would lie anywhere.
TEST(EdgeVertex, TakesNoiseForNoEdge) {
  const std::array<SurfacePlane, 2> planes = {
      {{{0, 0, 0}, Eigen::Vector3f(0.087f, 0, 1).normalized()}, {{1, 0, 0}, kZ}}};
  const EdgeVertex vertex = meet(planes);
  EXPECT_EQ(vertex.rank, 1);
  EXPECT_LT((vertex.position_m - Eigen::Vector3f(0.5f, 0, 0)).norm(), 0.05f);
}

TEST(EdgeVertexDeathTest, NoPlanesAreAMistake) { EXPECT_DEATH((void)meet({}), "no planes"); }

}  // namespace
}  // namespace hermite::mesh
