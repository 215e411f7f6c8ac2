#include "core/adjust/adjuster.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>

#include "tests/core/adjust/bundle_world.h"

namespace hermite::adjust {
namespace {

BundleProblem small_problem() {
  return test::disturbed(test::make_world({}).truth, 0.02, 0.01, 0.01, 7);
}

// Takes seconds: a long ring of links and a solver that is never content.
BundleProblem long_problem() { return test::make_ring(20'000, 0.01, 0.01, 3).drifted; }
constexpr BundleOptions kEndless{500, 500, 0};

std::optional<Result<BundleSolution>> poll_for(Adjuster& adjuster, std::chrono::seconds longest) {
  const auto end = std::chrono::steady_clock::now() + longest;
  std::optional<Result<BundleSolution>> result;
  while (!(result = adjuster.poll()) && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return result;
}

TEST(Adjuster, ReturnsWhatAdjustReturns) {
  const BundleProblem problem = small_problem();
  const Result<BundleSolution> expected = adjust(problem, {});
  ASSERT_TRUE(expected.ok());
  Adjuster adjuster;
  EXPECT_FALSE(adjuster.busy());
  adjuster.start(problem, {});
  EXPECT_TRUE(adjuster.busy());
  const Result<BundleSolution> result = adjuster.wait();
  EXPECT_FALSE(adjuster.busy());
  ASSERT_TRUE(result.ok());
  for (std::size_t i = 0; i < problem.world_from_submap.size(); ++i)
    EXPECT_TRUE(test::same_bits(result->world_from_submap[i], expected->world_from_submap[i])) << i;
}

TEST(Adjuster, HandsAResultOverOnceAndTakesTheNextJob) {
  Adjuster adjuster;
  EXPECT_FALSE(adjuster.poll().has_value());
  for (int i = 0; i < 3; ++i) {
    adjuster.start(small_problem(), {});
    const auto result = poll_for(adjuster, std::chrono::seconds(60));
    ASSERT_TRUE(result.has_value());
    EXPECT_TRUE(result->ok());
    EXPECT_FALSE(adjuster.busy());
    EXPECT_FALSE(adjuster.poll().has_value());
  }
}

TEST(Adjuster, ReturnsErrorsToo) {
  BundleProblem problem = small_problem();
  problem.is_fixed.assign(problem.is_fixed.size(), false);
  Adjuster adjuster;
  adjuster.start(problem, {});
  const Result<BundleSolution> result = adjuster.wait();
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
}

TEST(Adjuster, IsBusyWhileTheJobRunsAndGivesItUpWhenDestroyed) {
  auto adjuster = std::make_unique<Adjuster>();
  adjuster->start(long_problem(), kEndless);
  EXPECT_FALSE(adjuster->poll().has_value());
  EXPECT_TRUE(adjuster->busy());
  adjuster.reset();
}

TEST(AdjusterDeathTest, TakesOneJobAtATime) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        Adjuster adjuster;
        adjuster.start(long_problem(), kEndless);
        adjuster.start(small_problem(), {});
      },
      "before its last result was taken");
  EXPECT_DEATH(static_cast<void>(Adjuster().wait()), "without a running adjustment");
}

}  // namespace
}  // namespace hermite::adjust
