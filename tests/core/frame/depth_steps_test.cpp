#include "core/frame/depth_steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace hermite::frame::depth_steps_test {
namespace {

constexpr double kUnitsPerMetre = 5000, kNoise_px = 1.0 / 18;
constexpr double kFocalTimesBaseline_px_m = 525 * 0.075;

// A wall, tilted, at 2 m in the middle.
double wall_m(int x, int y) { return 1 / (0.5 + 8e-4 * (x - 160) + 1e-4 * (y - 120)); }

template <class Measure>
DepthImage measured(double units_per_metre, const Measure& measure_m) {
  DepthImage depth(320, 240);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      depth.at(x, y) =
          static_cast<std::uint16_t>(std::lround(units_per_metre * measure_m(wall_m(x, y))));
  return depth;
}

// As of a Kinect, with white noise.
DepthSteps steps_of_kinect(double steps_per_px) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise_px(0, kNoise_px);
  const auto measure_m = [&](double depth_m) {
    return kFocalTimesBaseline_px_m * steps_per_px /
           std::round((kFocalTimesBaseline_px_m / depth_m + noise_px(random)) * steps_per_px);
  };
  return measure_steps(measured(kUnitsPerMetre, measure_m), kUnitsPerMetre);
}

TEST(DepthSteps, AreThoseOfTheSensorsDisparity) {
  for (const double steps_per_px : {8, 4, 2}) {
    const DepthSteps steps = steps_of_kinect(steps_per_px);
    EXPECT_NEAR(steps.depth_m, 2, 0.1);
    const double expected_m =
        steps.depth_m * steps.depth_m / kFocalTimesBaseline_px_m / steps_per_px;
    EXPECT_NEAR(steps.step_m, expected_m, 0.15 * expected_m) << steps_per_px;
  }
}

TEST(DepthSteps, AreAveragedOutByNoiseThatReachesOverThem) {
  EXPECT_LT(steps_of_kinect(8).terrace_m, 0.1 * steps_of_kinect(8).step_m);
  EXPECT_GT(steps_of_kinect(4).terrace_m, 0.2 * steps_of_kinect(4).step_m);
  EXPECT_GT(steps_of_kinect(2).terrace_m, 0.5 * steps_of_kinect(2).step_m);
}

TEST(DepthSteps, OfDepthWithoutNoiseAreItsUnits) {
  const auto exactly = [](double depth_m) { return depth_m; };
  const DepthSteps fine = measure_steps(measured(kUnitsPerMetre, exactly), kUnitsPerMetre);
  EXPECT_LE(fine.terrace_m, fine.step_m);
  EXPECT_LT(fine.step_m, 0.0005);
  const DepthSteps centimetres = measure_steps(measured(100, exactly), 100);
  EXPECT_NEAR(centimetres.step_m, 0.01, 0.003) << "equal steps of depth are none of disparity";
  EXPECT_GT(centimetres.terrace_m, 0.006);
}

TEST(DepthSteps, AreNotKnownOfWhatHasTooFewValues) {
  DepthImage two_walls(320, 240);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) two_walls.at(x, y) = x < 160 ? 5000 : 10000;
  for (const DepthImage& depth : {DepthImage(), DepthImage(8, 8), DepthImage(320, 240), two_walls})
    EXPECT_EQ(measure_steps(depth, 5000).step_m, 0);
}

TEST(DepthSteps, AreAMeanOverFramesThatSurvivesBeingSaved) {
  SeenSteps steps;
  EXPECT_EQ(steps.mean().terrace_m, 0);
  steps.add({2, 0.02, 0.01});
  steps.add({});
  steps.add({4, 0.04, 0.03});
  EXPECT_DOUBLE_EQ(steps.mean().depth_m, 3);
  EXPECT_DOUBLE_EQ(steps.mean().step_m, 0.03);
  EXPECT_DOUBLE_EQ(steps.mean().terrace_m, 0.02);
  ByteWriter saved;
  steps.save(saved);
  const std::string bytes = saved.take();
  ByteReader reader(bytes);
  SeenSteps restored;
  restored.restore(reader);
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(restored.mean().terrace_m, steps.mean().terrace_m);
}

}  // namespace
}  // namespace hermite::frame::depth_steps_test
