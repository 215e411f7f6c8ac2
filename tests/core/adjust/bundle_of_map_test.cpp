#include "core/adjust/bundle_of_map.h"

#include <gtest/gtest.h>

#include <numeric>

namespace hermite::adjust {
namespace {

constexpr std::uint32_t kSubmaps = 12;

// Submaps on a ring, tracked from one to the next, the last with a loop to the first; they lie
// where links are off by `step_m` each.
struct Ring {
  explicit Ring(double step_m, bool is_closed = true) {
    map.camera = {320, 240, 262, 262, 159.5, 119.5, 5000};
    map.world_from_submap.clear();
    for (std::uint32_t i = 0; i < kSubmaps; ++i) {
      const double turn = 2 * M_PI * i / kSubmaps;
      Rigid3 pose = exp_se3((Vector6d() << 0, 0, 0, 0, turn, 0).finished());
      pose.translation = {std::sin(turn), 0, std::cos(turn)};
      map.world_from_submap.push_back(pose);
      add_submap(graph, 0);
    }
    for (std::uint32_t i = 0; i + 1 < kSubmaps; ++i) {
      Rigid3 measured = inverse(map.world_from_submap[i]) * map.world_from_submap[i + 1];
      measured.translation.y() += step_m;
      link_tracked(graph, i, i + 1, measured);
    }
    if (is_closed)
      graph.links.push_back(
          {kSubmaps - 1, 0, inverse(map.world_from_submap[kSubmaps - 1]) * map.world_from_submap[0],
           0, true});
  }

  BundleProblem problem() const {
    std::vector<std::uint32_t> all(kSubmaps);
    std::iota(all.begin(), all.end(), 0u);
    return bundle_of(map, graph, all).problem;
  }

  SparseMap map;
  SubmapGraph graph;
};

// How much more a link counts than information_of() says.
double gain(const Ring& ring, std::size_t link) {
  return ring.problem().links[link].information(0, 0) /
         information_of(ring.graph.links[link])(0, 0);
}

TEST(BundleOfMap, TrackingCountsMoreWhereALoopFindsItBetterThanSaid) {
  // A tenth of a millimetre a link where a few are said: the loop's six numbers against one.
  EXPECT_NEAR(gain(Ring(1e-4), 0), 7, 0.5);
  EXPECT_NEAR(gain(Ring(1e-4), kSubmaps - 2), 7, 0.5);
  EXPECT_DOUBLE_EQ(gain(Ring(1e-4), kSubmaps - 1), 1) << "loops are what they are said to be";
}

TEST(BundleOfMap, TrackingCountsAsSaidWithoutLoopsOrWhereTheyFindItWorse) {
  EXPECT_DOUBLE_EQ(gain(Ring(1e-4, false), 0), 1);
  EXPECT_DOUBLE_EQ(gain(Ring(0.02), 0), 1);
  const double between = gain(Ring(0.002), 0);
  EXPECT_GT(between, 1);
  EXPECT_LT(between, 7);
}

}  // namespace
}  // namespace hermite::adjust
