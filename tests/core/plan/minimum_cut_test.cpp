#include "core/plan/minimum_cut.h"

#include <gtest/gtest.h>

#include <random>

namespace hermite::plan::minimum_cut_test {
namespace {

double cost_of(const std::vector<bool>& inside, const std::vector<SideCost>& things,
               const std::vector<BoundaryCost>& boundaries) {
  double cost = 0;
  for (std::size_t i = 0; i < things.size(); ++i)
    cost += inside[i] ? things[i].inside : things[i].outside;
  for (const BoundaryCost& boundary : boundaries)
    if (inside[boundary.inside] && !inside[boundary.outside]) cost += boundary.cost;
  return cost;
}

// Against all divisions of eight things.
TEST(MinimumCut, IsTheCheapestOfAll) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> cost(0, 1);
  constexpr std::size_t kCount = 8;
  for (int round = 0; round < 200; ++round) {
    std::vector<SideCost> things;
    std::vector<BoundaryCost> boundaries;
    for (std::size_t i = 0; i < kCount; ++i) things.push_back({cost(random), cost(random)});
    for (std::size_t i = 0; i < kCount; ++i)
      for (std::size_t j = 0; j < kCount; ++j)
        if (i != j && cost(random) < 0.4)
          boundaries.push_back({i, j, cost(random) < 0.2 ? 0 : cost(random)});
    double best = 1e9;
    for (unsigned division = 0; division < 1u << kCount; ++division) {
      std::vector<bool> inside;
      for (std::size_t i = 0; i < kCount; ++i) inside.push_back((division >> i & 1) != 0);
      best = std::min(best, cost_of(inside, things, boundaries));
    }
    EXPECT_NEAR(cost_of(minimum_cut(things, boundaries), things, boundaries), best, 1e-9)
        << "round " << round;
  }
}

TEST(MinimumCut, OfNothingIsNothing) { EXPECT_TRUE(minimum_cut({}, {}).empty()); }

}  // namespace
}  // namespace hermite::plan::minimum_cut_test
