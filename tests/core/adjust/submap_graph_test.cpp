#include "core/adjust/submap_graph.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::adjust {
namespace {

Rigid3 along_x(double metres) { return {Eigen::Quaterniond::Identity(), {metres, 0, 0}}; }
Rigid3 turned(double rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(rad, Eigen::Vector3d::UnitY())),
          Eigen::Vector3d::Zero()};
}

// Submaps 0 to count - 1 in a row, a metre apart.
SubmapGraph chain(std::uint32_t count) {
  SubmapGraph graph;
  for (std::uint32_t i = 0; i < count; ++i) {
    add_submap(graph, 0);
    if (i > 0) link_tracked(graph, i - 1, i, along_x(1));
  }
  return graph;
}

TEST(SubmapGraph, ATurnIsAWayToo) {
  EXPECT_DOUBLE_EQ(length_of(Rigid3{}), 0);
  EXPECT_DOUBLE_EQ(length_of(along_x(-2)), 2);
  EXPECT_NEAR(length_of(turned(1)), 0.5, 1e-12);
  EXPECT_NEAR(length_of(inverse(turned(1) * along_x(2))), length_of(turned(1) * along_x(2)), 1e-12);
}

TEST(SubmapGraph, NewSubmapsAreTheirOwnParents) {
  SubmapGraph graph = chain(2);
  EXPECT_EQ(add_submap(graph, 5), 2u);
  EXPECT_EQ(graph.component, (std::vector<std::uint32_t>{0, 0, 5}));
  EXPECT_EQ(graph.parent, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(SubmapGraph, TwoSubmapsAreTiedOnceByTracking) {
  SubmapGraph graph = chain(2);
  link_tracked(graph, 0, 1, along_x(7));
  link_tracked(graph, 1, 0, along_x(-7));
  ASSERT_EQ(graph.links.size(), 1u);
  EXPECT_DOUBLE_EQ(graph.links[0].length_m, 1);
}

TEST(SubmapGraph, TrackingTiesSubmapsThatALoopTiesAlready) {
  SubmapGraph graph = chain(3);
  graph.links.push_back({0, 2, along_x(2), 0, true});
  link_tracked(graph, 2, 0, along_x(-2));
  EXPECT_EQ(graph.links.size(), 4u);
}

TEST(SubmapGraph, WaysAreTheShortestAlongLinks) {
  SubmapGraph graph = chain(6);
  EXPECT_EQ(distances_m(graph, 2), (std::vector<double>{2, 1, 0, 1, 2, 3}));
  graph.links.push_back({0, 5, along_x(5), 0, true});
  EXPECT_EQ(distances_m(graph, 0), (std::vector<double>{0, 1, 2, 2, 1, 0}));
}

TEST(SubmapGraph, ThereIsNoWayToAnotherPart) {
  SubmapGraph graph = chain(2);
  add_submap(graph, 1);
  EXPECT_TRUE(std::isinf(distances_m(graph, 0)[2]));
  EXPECT_TRUE(std::isinf(distances_m(graph, 2)[0]));
  EXPECT_EQ(distances_m(graph, 2)[2], 0);
}

TEST(SubmapGraph, LongLinksAreKnownLessWellAndLoopsAlike) {
  const auto information = [](const Rigid3& pose, bool is_loop) {
    return information_of({0, 1, pose, 0, is_loop});
  };
  EXPECT_GT(information(along_x(0.1), false)(0, 0), information(along_x(1), false)(0, 0));
  EXPECT_GT(information(turned(0.1), false)(5, 5), information(turned(1), false)(5, 5));
  EXPECT_EQ(information(along_x(0.1), true), information(along_x(3), true));
  EXPECT_TRUE(information(along_x(0.1) * turned(0.5), false).isDiagonal());
}

TEST(SubmapGraph, DriftGrowsWithTheWay) {
  EXPECT_TRUE(is_possible_drift(Rigid3{}, 0));
  EXPECT_TRUE(is_possible_drift(along_x(0.3), 10));
  EXPECT_FALSE(is_possible_drift(along_x(0.3), 1));
  EXPECT_TRUE(is_possible_drift(turned(0.2), 10));
  EXPECT_FALSE(is_possible_drift(turned(0.2), 1));
  // The next of identical rooms 5 m apart, after a walk of 20 m.
  EXPECT_FALSE(is_possible_drift(along_x(5), 20));
}

}  // namespace
}  // namespace hermite::adjust
