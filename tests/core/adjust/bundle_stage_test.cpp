#include "core/adjust/bundle_stage.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/adjust/bundle_world.h"

namespace hermite::adjust {
namespace {

struct Start {
  BundleProblem problem;
  BundleStage stage;
  BundleState state;
};

Start start_of(const BundleProblem& problem) {
  BundleStage stage;
  stage.submap_is_held = problem.is_fixed;
  stage.observation_is_used.assign(problem.observations.size(), true);
  stage.iterations = 20;
  stage.least_progress = 1e-6;
  return {problem, stage, {problem.world_from_submap, problem.landmarks_in_world}};
}

TEST(BundleStage, UnusedObservationsCountForNothing) {
  const test::World world = test::make_world({});
  Start start = start_of(test::disturbed(world.truth, 0.02, 0.01, 0.01, 1));
  for (std::size_t i = 0; i < start.problem.observations.size(); i += 7) {
    start.problem.observations[i].pixel_px = {0, 0};
    start.stage.observation_is_used[i] = false;
  }
  const StageOutcome outcome = solve_stage(start.problem, start.stage, {}, start.state);
  EXPECT_TRUE(outcome.converged);
  EXPECT_LT(test::largest_distance_m(start.state.world_from_submap, world.truth.world_from_submap),
            1e-7);
}

TEST(BundleStage, HoldsWhomItIsTold) {
  Start start = start_of(test::disturbed(test::make_world({}).truth, 0.02, 0.01, 0.01, 2));
  start.stage.submap_is_held[6] = true;
  const BundleState before = start.state;
  EXPECT_GT(solve_stage(start.problem, start.stage, {}, start.state).iteration_count, 0);
  for (std::size_t i = 0; i < before.world_from_submap.size(); ++i)
    EXPECT_EQ(test::same_bits(before.world_from_submap[i], start.state.world_from_submap[i]),
              i == 0 || i == 6)
        << i;
}

TEST(BundleStage, TakesNoMoreIterationsThanAllowed) {
  Start start = start_of(test::disturbed(test::make_world({}).truth, 0.1, 0.1, 0.1, 3));
  start.stage.iterations = 2;
  const StageOutcome outcome = solve_stage(start.problem, start.stage, {}, start.state);
  EXPECT_EQ(outcome.iteration_count, 2);
  EXPECT_FALSE(outcome.converged);
}

TEST(BundleStage, WithNothingFreeDoesNothing) {
  Start start = start_of(test::make_ring(5, 0.01, 0.01, 4).drifted);
  start.stage.submap_is_held.assign(5, true);
  const StageOutcome outcome = solve_stage(start.problem, start.stage, {}, start.state);
  EXPECT_EQ(outcome.iteration_count, 0);
  EXPECT_TRUE(outcome.converged);
}

TEST(BundleStage, StopsWhenAsked) {
  Start start = start_of(test::disturbed(test::make_world({}).truth, 0.1, 0.1, 0.1, 5));
  std::stop_source source;
  source.request_stop();
  const StageOutcome outcome =
      solve_stage(start.problem, start.stage, source.get_token(), start.state);
  EXPECT_TRUE(outcome.stopped);
  EXPECT_LE(outcome.iteration_count, 1);
}

TEST(CauchyCost, IsHalfTheSquareNearZeroAndGrowsSlowlyBeyond) {
  EXPECT_NEAR(cauchy_cost(1e-6, 8), 0.5e-6, 1e-12);
  EXPECT_NEAR(cauchy_cost(8, 8), 4 * std::log(2), 1e-12);
  EXPECT_LT(cauchy_cost(8e6, 8), 64);  // 4 ln(1e6)
}

}  // namespace
}  // namespace hermite::adjust
