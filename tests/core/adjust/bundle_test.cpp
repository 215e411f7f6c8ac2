#include "core/adjust/bundle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <future>

#include "core/adjust/bundle_noise.h"
#include "tests/core/adjust/bundle_world.h"

namespace hermite::adjust {
namespace {

using test::WorldOptions;

std::size_t count(const std::vector<bool>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
}

bool same_bits(const BundleSolution& a, const BundleSolution& b) {
  bool same = a.observation_is_inlier == b.observation_is_inlier && a.link_chi2 == b.link_chi2 &&
              a.final_cost == b.final_cost;
  for (std::size_t i = 0; i < a.world_from_submap.size(); ++i)
    same &= test::same_bits(a.world_from_submap[i], b.world_from_submap[i]);
  for (std::size_t i = 0; i < a.landmarks_in_world.size(); ++i)
    same &= std::memcmp(a.landmarks_in_world[i].data(), b.landmarks_in_world[i].data(),
                        3 * sizeof(double)) == 0;
  return same;
}

BundleSolution solved(const BundleProblem& problem, const BundleOptions& options = {}) {
  Result<BundleSolution> result = adjust(problem, options);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  return result.ok() ? *std::move(result) : BundleSolution{};
}

// Enough for any start of these tests to end in its minimum.
constexpr BundleOptions kToTheEnd{50, 50, 1e-12};

TEST(Bundle, ExactDataGiveTheTruthBack) {
  const test::World world = test::make_world({});
  const BundleProblem start = test::disturbed(world.truth, 0.1, 0.05, 0.1, 2);
  const BundleSolution solution = solved(start);
  EXPECT_TRUE(solution.converged);
  EXPECT_GT(test::largest_distance_m(start.world_from_submap, world.truth.world_from_submap), 0.1);
  // Gauss-Newton on exact data squares the error at each step, so the step before the last being
  // small leaves rounding.
  EXPECT_LT(test::largest_distance_m(solution.world_from_submap, world.truth.world_from_submap),
            1e-7);
  EXPECT_LT(test::largest_angle_rad(solution.world_from_submap, world.truth.world_from_submap),
            1e-7);
  for (const BundleObservation& observation : start.observations)
    EXPECT_LT((solution.landmarks_in_world[observation.landmark] -
               world.truth.landmarks_in_world[observation.landmark])
                  .norm(),
              1e-6);
  EXPECT_EQ(count(solution.observation_is_inlier), start.observations.size());
  EXPECT_LT(solution.final_cost, 1e-6);
}

// Keyframes that stand a fifth of a degree askew in their submap turn it; a link that knows better
// turns it back, the more the less they weigh.
TEST(Bundle, KeyframesPullAsMuchAsTheyWeigh) {
  const test::World world = test::make_world({});
  const auto turned_rad = [&world](double weight) {
    BundleProblem problem = world.truth;
    for (BundleKeyframe& keyframe : problem.keyframes) {
      if (keyframe.submap != 5) continue;
      keyframe.weight = weight;
      keyframe.submap_from_camera =
          exp_se3((Vector6d() << 0, 0, 0, 0, 0.0035, 0).finished()) * keyframe.submap_from_camera;
    }
    const std::vector<Rigid3>& poses = problem.world_from_submap;
    problem.links.push_back(
        {4, 5, inverse(poses[4]) * poses[5], test::information_of(0.001, 0.001), false});
    return angle_rad(
        inverse(solved(problem, kToTheEnd).world_from_submap[5] * inverse(poses[5])).rotation);
  };
  const double heavy = turned_rad(1), light = turned_rad(0.01), lightest = turned_rad(1e-4);
  EXPECT_GT(heavy, 0.002);
  EXPECT_LT(light, 0.7 * heavy);
  EXPECT_LT(lightest, 0.1 * heavy);
}

// Wrong near depths have deviations of a millimetre and must not outweigh the right ones.
TEST(Bundle, HalfOfTheObservationsMayBeWrong) {
  WorldOptions options;
  options.noise = 1;
  options.outliers = 0.5;
  const test::World world = test::make_world(options);
  const BundleProblem start = test::disturbed(world.truth, 0.05, 0.03, 0.02, 16);
  const BundleSolution solution = solved(start);
  EXPECT_LT(test::rms_distance_m(solution.world_from_submap, world.truth.world_from_submap),
            0.7 * test::rms_distance_m(start.world_from_submap, world.truth.world_from_submap));
}

TEST(Bundle, PixelsWithoutDepthDoToo) {
  WorldOptions options;
  options.with_depth = false;
  const test::World world = test::make_world(options);
  // Pixels do not know the size of the world: two fixed submaps do.
  BundleProblem truth = world.truth;
  truth.is_fixed[1] = true;
  const BundleSolution solution = solved(test::disturbed(truth, 0.02, 0.01, 0.02, 3), kToTheEnd);
  EXPECT_LT(test::largest_distance_m(solution.world_from_submap, truth.world_from_submap), 1e-6);
}

TEST(Bundle, NoiseLeavesWhatItAllows) {
  WorldOptions options;
  options.noise = 1;
  const test::World world = test::make_world(options);
  const BundleProblem start = test::disturbed(world.truth, 0.05, 0.03, 0.05, 4);
  const BundleSolution solution = solved(start);
  const double before_m =
      test::rms_distance_m(start.world_from_submap, world.truth.world_from_submap);
  const double after_m =
      test::rms_distance_m(solution.world_from_submap, world.truth.world_from_submap);
  EXPECT_LT(after_m, 0.3 * before_m);
  // Of residuals with those deviations 95 % lie within the bound. The solution takes a quarter of
  // the freedom from them: some more do.
  const double inlier_part = static_cast<double>(count(solution.observation_is_inlier)) /
                             static_cast<double>(start.observations.size());
  EXPECT_GT(inlier_part, 0.95);
  EXPECT_LT(inlier_part, 0.99);
  EXPECT_LT(solution.final_cost, solution.initial_cost);
}

TEST(Bundle, ErrorsAreProportionalToTheNoise) {
  WorldOptions options;
  double rms_m[2];
  for (const int i : {0, 1}) {
    options.noise = i == 0 ? 0.5 : 0.25;
    const test::World world = test::make_world(options);
    rms_m[i] = test::rms_distance_m(solved(world.truth, kToTheEnd).world_from_submap,
                                    world.truth.world_from_submap);
  }
  // The same draws, near the truth, where the problem is linear.
  EXPECT_NEAR(rms_m[0] / rms_m[1], 2, 0.1);
}

TEST(Bundle, OutliersAreFoundAndDoNoHarm) {
  WorldOptions options;
  options.noise = 1;
  const test::World clean = test::make_world(options);
  options.outliers = 0.2;
  const test::World world = test::make_world(options);
  const BundleSolution solution = solved(test::disturbed(world.truth, 0.05, 0.03, 0.02, 5));
  const double clean_m =
      test::rms_distance_m(solved(clean.truth).world_from_submap, clean.truth.world_from_submap);
  // A fifth fewer observations and another draw of their noise: not the same error, but one of that
  // size.
  EXPECT_LT(test::rms_distance_m(solution.world_from_submap, world.truth.world_from_submap),
            2 * clean_m);
  std::size_t outlier_count = 0, missed_count = 0, wronged_count = 0;
  for (std::size_t i = 0; i < solution.observation_is_inlier.size(); ++i) {
    outlier_count += world.observation_is_outlier[i];
    missed_count += world.observation_is_outlier[i] && solution.observation_is_inlier[i];
    wronged_count += !world.observation_is_outlier[i] && !solution.observation_is_inlier[i];
  }
  ASSERT_GT(outlier_count, 100u);
  // A landmark with two observations of which one is wrong has no majority.
  EXPECT_LE(missed_count, outlier_count / 50);
  // The bound takes 5 % of them.
  EXPECT_LT(static_cast<double>(wronged_count),
            0.05 * static_cast<double>(solution.observation_is_inlier.size() - outlier_count));
}

TEST(Bundle, LocalAdjustmentMovesOnlyWhatIsFree) {
  const test::World world = test::make_world({});
  BundleProblem truth = world.truth;
  truth.is_fixed.assign(truth.is_fixed.size(), true);
  truth.is_fixed[3] = truth.is_fixed[4] = false;
  const BundleProblem start = test::disturbed(truth, 0.05, 0.03, 0.02, 6);
  const BundleSolution solution = solved(start);
  for (std::size_t i = 0; i < truth.is_fixed.size(); ++i) {
    EXPECT_EQ(test::same_bits(solution.world_from_submap[i], start.world_from_submap[i]),
              truth.is_fixed[i])
        << i;
  }
  EXPECT_LT(test::largest_distance_m(solution.world_from_submap, truth.world_from_submap), 1e-7);
}

TEST(Bundle, LandmarksAloneAreSolvedToo) {
  const test::World world = test::make_world({});
  BundleProblem truth = world.truth;
  truth.is_fixed.assign(truth.is_fixed.size(), true);
  const BundleSolution solution = solved(test::disturbed(truth, 0, 0, 0.05, 7));
  for (const BundleObservation& observation : truth.observations)
    EXPECT_LT((solution.landmarks_in_world[observation.landmark] -
               truth.landmarks_in_world[observation.landmark])
                  .norm(),
              1e-6);
  EXPECT_LT(solution.final_cost, 1e-9 * solution.initial_cost + 1e-6);
}

TEST(Bundle, CostsCompareProblemAndSolution) {
  WorldOptions options;
  options.noise = 1;
  options.outliers = 0.1;
  BundleProblem problem = test::disturbed(test::make_world(options).truth, 0.02, 0.01, 0.01, 8);
  problem.links.push_back({0, 1, Rigid3(), test::information_of(1, 1), true});
  const BundleSolution solution = solved(problem);
  problem.world_from_submap = solution.world_from_submap;
  problem.landmarks_in_world = solution.landmarks_in_world;
  EXPECT_EQ(solved(problem).initial_cost, solution.final_cost);
}

TEST(Bundle, TwoRunsAgreeToTheBit) {
  WorldOptions options;
  options.noise = 1;
  options.outliers = 0.1;
  const BundleProblem problem =
      test::disturbed(test::make_world(options).truth, 0.05, 0.03, 0.02, 9);
  const BundleSolution first = solved(problem);
  const BundleProblem elsewhere = problem;  // at other addresses
  const std::vector<char> shifts_the_heap(12345);
  EXPECT_TRUE(same_bits(first, solved(elsewhere)));
}

// Landmark 0 is seen once, landmark 1 never, the rest as made.
TEST(Bundle, LandmarksThatNothingHoldsMoveWithTheirSubmap) {
  const test::World world = test::make_world({});
  BundleProblem truth = world.truth;
  const std::uint32_t submap = 4;
  std::erase_if(truth.observations,
                [](const BundleObservation& observation) { return observation.landmark < 2; });
  const std::uint32_t keyframe = submap * 4;
  BundleObservation once{keyframe, 0, {320, 240}, 2, 1};
  truth.observations.push_back(once);
  const BundleProblem start = test::disturbed(truth, 0.05, 0.03, 0.02, 10);
  const BundleSolution solution = solved(start);
  ASSERT_FALSE(
      test::same_bits(solution.world_from_submap[submap], start.world_from_submap[submap]));
  const Eigen::Vector3d before =
      inverse(start.world_from_submap[submap]) * start.landmarks_in_world[0];
  const Eigen::Vector3d after =
      inverse(solution.world_from_submap[submap]) * solution.landmarks_in_world[0];
  EXPECT_LT((before - after).norm(), 1e-12);
  EXPECT_EQ(solution.landmarks_in_world[1], start.landmarks_in_world[1]);
}

TEST(Bundle, WhatLiesBehindTheCameraIsLeftOut) {
  const test::World world = test::make_world({});
  BundleProblem problem = world.truth;
  // The middle of the circle is behind every camera.
  problem.landmarks_in_world[0] = Eigen::Vector3d::Zero();
  const BundleSolution solution = solved(problem);
  for (std::size_t i = 0; i < problem.observations.size(); ++i)
    EXPECT_EQ(solution.observation_is_inlier[i], problem.observations[i].landmark != 0) << i;
  EXPECT_LT(test::largest_distance_m(solution.world_from_submap, world.truth.world_from_submap),
            1e-9);
}

TEST(Bundle, SubmapsWhoseEveryObservationIsWrongStayNearTheirStart) {
  const test::World world = test::make_world({});
  BundleProblem problem = world.truth;
  std::mt19937 random(11);
  for (BundleObservation& observation : problem.observations)
    if (problem.keyframes[observation.keyframe].submap == 5)
      observation.pixel_px = {320 + 320 * test::uniform(random), 240 + 240 * test::uniform(random)};
  const BundleSolution solution = solved(problem);
  EXPECT_TRUE(is_finite(solution.world_from_submap[5]));
  for (std::size_t i = 0; i < problem.world_from_submap.size(); ++i) {
    if (i == 5) continue;
    EXPECT_LT((solution.world_from_submap[i].translation - problem.world_from_submap[i].translation)
                  .norm(),
              1e-3)
        << i;
  }
}

TEST(BundleLinks, ARingWithDriftCloses) {
  const test::Ring ring = test::make_ring(60, 0.01, 0.003, 12);
  const double gap_m =
      (ring.drifted.world_from_submap.back().translation - ring.truth.back().translation).norm();
  ASSERT_GT(gap_m, 0.1);  // else there is nothing to show
  const BundleSolution solution = solved(ring.drifted);
  EXPECT_TRUE(solution.converged);
  // The loop is as exact as its neighbours, of which there are 59: the gap that is left is about a
  // sixtieth.
  EXPECT_LT((solution.world_from_submap.back().translation - ring.truth.back().translation).norm(),
            0.1 * gap_m);
  EXPECT_LT(solution.link_chi2.back(), kPoseChi2);
  EXPECT_LT(test::rms_distance_m(solution.world_from_submap, ring.truth),
            0.6 * test::rms_distance_m(ring.drifted.world_from_submap, ring.truth));
  // Spread: no link takes more than its share.
  EXPECT_LT(*std::max_element(solution.link_chi2.begin(), solution.link_chi2.end()), kPoseChi2);
}

TEST(BundleLinks, AWrongRobustLoopBendsLittle) {
  test::Ring ring = test::make_ring(60, 0.01, 0.003, 12);
  const BundleSolution right = solved(ring.drifted);
  // Says that two places 10 m apart are the same.
  ring.drifted.links.push_back({10, 40, Rigid3(), test::information_of(0.01, 0.003), true});
  const BundleSolution solution = solved(ring.drifted);
  EXPECT_LT(test::largest_distance_m(solution.world_from_submap, right.world_from_submap), 0.02);
  EXPECT_GT(solution.link_chi2.back(), 1e4);
  ring.drifted.links.back().robust = false;
  EXPECT_GT(
      test::largest_distance_m(solved(ring.drifted).world_from_submap, right.world_from_submap), 1);
}

TEST(BundleLinks, HalfTurnsAreNoObstacle) {
  const double half_turn = 179.0 * M_PI / 180.0;
  BundleProblem problem;
  std::mt19937 random(13);
  std::vector<Rigid3> truth;
  for (std::uint32_t i = 0; i < 6; ++i) {
    Vector6d twist = test::random_twist(random, 1, 1);
    twist.tail<3>() *= half_turn / twist.tail<3>().norm();
    truth.push_back(i == 0 ? exp_se3(twist) : truth.back() * exp_se3(twist));
    if (i > 0)
      problem.links.push_back(
          {i - 1, i, inverse(truth[i - 1]) * truth[i], test::information_of(0.01, 0.01), false});
  }
  problem.is_fixed = {true, false, false, false, false, false};
  problem.world_from_submap = truth;
  problem = test::disturbed(problem, 0.3, 0.3, 0, 14);
  // And one that starts the wrong way round.
  problem.world_from_submap[5] =
      truth[5] * exp_se3((Vector6d() << 0, 0, 0, half_turn, 0, 0).finished());
  const BundleSolution solution = solved(problem);
  EXPECT_LT(test::largest_distance_m(solution.world_from_submap, truth), 1e-6);
  EXPECT_LT(test::largest_angle_rad(solution.world_from_submap, truth), 1e-6);
}

TEST(BundleLinks, HoldTogetherWhatLandmarksDoNot) {
  // Two halves of a world that share no landmark, and the link between them.
  const test::World world = test::make_world({});
  BundleProblem problem = world.truth;
  std::vector<int> side(problem.landmarks_in_world.size(), -1);
  std::erase_if(problem.observations, [&](const BundleObservation& observation) {
    const int here = problem.keyframes[observation.keyframe].submap < 4 ? 0 : 1;
    if (side[observation.landmark] < 0) side[observation.landmark] = here;
    return side[observation.landmark] != here;
  });
  EXPECT_FALSE(adjust(problem, {}).ok());
  const Rigid3 measured = inverse(problem.world_from_submap[3]) * problem.world_from_submap[4];
  problem.links.push_back({3, 4, measured, test::information_of(0.001, 0.001), false});
  const BundleSolution solution = solved(test::disturbed(problem, 0.03, 0.02, 0.02, 15), kToTheEnd);
  EXPECT_LT(test::largest_distance_m(solution.world_from_submap, problem.world_from_submap), 1e-5);
}

TEST(Bundle, NothingToDoIsASolution) {
  const BundleSolution nothing = solved({});
  EXPECT_TRUE(nothing.converged);
  EXPECT_EQ(nothing.iteration_count, 0);
  EXPECT_EQ(nothing.final_cost, 0);

  BundleProblem one;
  one.world_from_submap = {exp_se3((Vector6d() << 1, 2, 3, 0.1, 0.2, 0.3).finished())};
  one.is_fixed = {true};
  const BundleSolution solution = solved(one);
  EXPECT_TRUE(solution.converged);
  EXPECT_TRUE(test::same_bits(solution.world_from_submap[0], one.world_from_submap[0]));
}

TEST(Bundle, AWrongProblemIsAnErrorWithAMessage) {
  BundleProblem problem = test::make_world({}).truth;
  problem.is_fixed[0] = false;
  const Result<BundleSolution> loose = adjust(problem, {});
  ASSERT_FALSE(loose.ok());
  EXPECT_EQ(loose.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(loose.error().message.find("world_from_submap[0]"), std::string::npos);
  problem.is_fixed[0] = true;
  problem.observations[17].depth_m = std::nan("");
  const Result<BundleSolution> nan = adjust(problem, {});
  ASSERT_FALSE(nan.ok());
  EXPECT_NE(nan.error().message.find("observations[17].depth_m"), std::string::npos);
}

TEST(Bundle, GivesUpOnTheWayWhenAsked) {
  // The whole of it takes seconds, so the word comes while it works.
  const BundleProblem problem = test::make_ring(20'000, 0.01, 0.01, 3).drifted;
  std::stop_source source;
  std::future<Result<BundleSolution>> result = std::async(std::launch::async, [&] {
    return adjust(problem, {500, 500, 0}, source.get_token());
  });
  EXPECT_EQ(result.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
  source.request_stop();
  const Result<BundleSolution> given_up = result.get();
  ASSERT_FALSE(given_up.ok());
  EXPECT_EQ(given_up.error().code, ErrorCode::kBusy);
}

TEST(Bundle, GivesUpWhenAskedBefore) {
  std::stop_source source;
  source.request_stop();
  const Result<BundleSolution> result = adjust(test::make_world({}).truth, {}, source.get_token());
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kBusy);
}

}  // namespace
}  // namespace hermite::adjust
