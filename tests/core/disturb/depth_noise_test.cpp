#include "core/disturb/depth_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace hermite::disturb {
namespace {

using testing::HasSubstr;

const Camera kCamera{320, 240, 262, 262, 159.5, 119.5, 5000};

DepthImage wall(double depth_m, const Camera& camera = kCamera) {
  DepthImage depth(camera.width, camera.height);
  for (auto& pixel : depth.pixels)
    pixel = static_cast<std::uint16_t>(std::lround(depth_m * camera.depth_units_per_metre));
  return depth;
}

struct Moments {
  double mean_m = 0, sigma_m = 0;
  std::size_t count = 0;
};

Moments moments_of(const DepthImage& depth, double units_per_metre) {
  Moments moments;
  double sum = 0, sum2 = 0;
  for (const std::uint16_t value : depth.pixels) {
    if (value == 0) continue;
    const double depth_m = value / units_per_metre;
    sum += depth_m;
    sum2 += depth_m * depth_m;
    ++moments.count;
  }
  moments.mean_m = sum / static_cast<double>(moments.count);
  moments.sigma_m = std::sqrt(
      std::max(0.0, sum2 / static_cast<double>(moments.count) - moments.mean_m * moments.mean_m));
  return moments;
}

TEST(DepthNoise, GaussianHasTheAskedForSpread) {
  for (const double sigma_m : {0.003, 0.012}) {
    const Moments moments =
        moments_of(add_noise(wall(2.0), kCamera, {NoiseModel::kGaussian, sigma_m, 1}, 0), 5000);
    EXPECT_EQ(moments.count, 320u * 240u);
    EXPECT_NEAR(moments.mean_m, 2.0, 5 * sigma_m / std::sqrt(320 * 240)) << "five standard errors";
    EXPECT_NEAR(moments.sigma_m, sigma_m, 0.02 * sigma_m);
  }
}

TEST(DepthNoise, NeighbouringPixelsAreIndependent) {
  const DepthImage noisy = add_noise(wall(2.0), kCamera, {NoiseModel::kGaussian, 0.01, 1}, 0);
  double product = 0;
  for (int y = 0; y < 240; ++y)
    for (int x = 1; x < 320; ++x)
      product += (noisy.at(x, y) / 5000.0 - 2.0) * (noisy.at(x - 1, y) / 5000.0 - 2.0);
  const double correlation = product / (319 * 240) / (0.01 * 0.01);
  EXPECT_NEAR(correlation, 0, 5 / std::sqrt(319 * 240)) << "five standard errors";
}

// Disparity noise s_d moves depth by z^2 / (f b) s_d; rounding to 1/8 px adds 1/(8 sqrt(12)) px.
TEST(DepthNoise, KinectGrowsWithTheSquareOfDepth) {
  const double disparity_sigma_px = std::hypot(1.0 / 18, 1 / (8 * std::sqrt(12)));
  for (const NoiseModel model : {NoiseModel::kKinect, NoiseModel::kKinectWhite})
    for (const double depth_m : {2.0, 3.0, 4.0}) {
      const Moments moments = moments_of(add_noise(wall(depth_m), kCamera, {model, 0, 7}, 3), 5000);
      const double expected_m = depth_m * depth_m / (525 * 0.075) * disparity_sigma_px;
      EXPECT_NEAR(moments.sigma_m, expected_m, 0.1 * expected_m) << depth_m;
    }
}

// Spectrum of a wall that runs away from the camera, so that disparities come to lie anywhere
// between two steps of an eighth.
struct Spectrum {
  double variance_px2 = 0;
  double right[6] = {}, down[6] = {};  // correlation at a lag of so many pixels
};

Spectrum spectrum_of(NoiseModel model) {
  const Camera fine{320, 240, 262, 262, 159.5, 119.5, 20000};
  const auto disparity_px = [](std::uint16_t value) { return 525 * 0.075 / (value / 20000.0); };
  DepthImage leaning(fine.width, fine.height);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x)
      leaning.at(x, y) =
          static_cast<std::uint16_t>(std::lround(20000 * 2.0 / (1 + 1e-4 * x + 2e-4 * y)));
  Spectrum spectrum;
  double count = 0;
  for (std::int64_t frame = 0; frame < 4; ++frame) {
    const DepthImage noisy = add_noise(leaning, fine, {model, 0, 7}, frame);
    const auto error_px = [&](int x, int y) {
      return disparity_px(noisy.at(x, y)) - disparity_px(leaning.at(x, y));
    };
    for (int y = 0; y < fine.height - 5; ++y)
      for (int x = 0; x < fine.width - 5; ++x) {
        const double here_px = error_px(x, y);
        count += 1;
        for (int lag = 0; lag <= 5; ++lag) {
          spectrum.right[lag] += here_px * error_px(x + lag, y);
          spectrum.down[lag] += here_px * error_px(x, y + lag);
        }
      }
  }
  spectrum.variance_px2 = spectrum.right[0] / count;
  for (int lag = 5; lag >= 0; --lag) {
    spectrum.right[lag] /= spectrum.right[0];
    spectrum.down[lag] /= spectrum.down[0];
  }
  return spectrum;
}

// As measured on planes that a Kinect v1 recorded: 0.6, 0.45 and 0.3 at one, two and three pixels.
TEST(DepthNoise, KinectsNeighboursErrAlike) {
  const Spectrum kinect = spectrum_of(NoiseModel::kKinect);
  constexpr double kMeasured[] = {1, 0.6, 0.45, 0.3};
  for (int lag = 1; lag <= 3; ++lag) {
    EXPECT_NEAR(kinect.right[lag], kMeasured[lag], 0.04) << lag;
    EXPECT_NEAR(kinect.down[lag], kMeasured[lag], 0.04) << lag;
  }
  EXPECT_NEAR(kinect.right[5], 0, 0.03);
  EXPECT_NEAR(kinect.down[5], 0, 0.03);
}

TEST(DepthNoise, WhiteKinectsNeighboursDoNotAndBothHaveTheSameVariance) {
  const Spectrum white = spectrum_of(NoiseModel::kKinectWhite);
  for (int lag = 1; lag <= 5; ++lag) {
    EXPECT_NEAR(white.right[lag], 0, 0.01) << lag;
    EXPECT_NEAR(white.down[lag], 0, 0.01) << lag;
  }
  EXPECT_NEAR(white.variance_px2, 1 / 324.0 + 1 / 768.0, 1e-4)
      << "of the Gaussian and of the rounding";
  EXPECT_NEAR(spectrum_of(NoiseModel::kKinect).variance_px2, white.variance_px2,
              0.03 * white.variance_px2);
}

TEST(DepthNoise, KinectDisparitiesAreEighthsOfAPixel) {
  const Camera fine{320, 240, 262, 262, 159.5, 119.5, 20000};
  for (const std::uint16_t value :
       add_noise(wall(1.1, fine), fine, {NoiseModel::kKinect, 0, 7}, 0).pixels) {
    const double eighths = 8 * 525 * 0.075 / (value / 20000.0);
    ASSERT_NEAR(eighths, std::round(eighths), 0.02) << "rounded to 0.05 mm";
  }
}

TEST(DepthNoise, KinectDisparitiesAreAsCoarseAsAsked) {
  const Camera fine{320, 240, 262, 262, 159.5, 119.5, 20000};
  std::set<std::uint16_t> values;
  for (const std::uint16_t value :
       add_noise(wall(1.1, fine), fine, *parse_noise("kinect,steps_per_px=4"), 0).pixels) {
    const double quarters = 4 * 525 * 0.075 / (value / 20000.0);
    ASSERT_NEAR(quarters, std::round(quarters), 0.02);
    values.insert(value);
  }
  EXPECT_GE(values.size(), 2u) << "noise reaches neighbouring steps";
  EXPECT_LE(values.size(), 4u);
}

TEST(DepthNoise, KinectSeesFromFortyCentimetresToFiveMetres) {
  const auto valid = [](double depth_m) {
    return moments_of(add_noise(wall(depth_m), kCamera, {NoiseModel::kKinect, 0, 1}, 0), 5000)
        .count;
  };
  EXPECT_EQ(valid(0.38), 0u);
  EXPECT_EQ(valid(0.5), 320u * 240u);
  EXPECT_EQ(valid(4.5), 320u * 240u);
  EXPECT_EQ(valid(6.0), 0u);
}

// Half a pixel of lateral noise: at a step edge about a third of the pixels beside it read the
// other side, none further than 4 pixels away.
TEST(DepthNoise, KinectFraysEdges) {
  DepthImage step = wall(1.0);
  for (int y = 0; y < step.height; ++y)
    for (int x = 160; x < step.width; ++x) step.at(x, y) = 10000;
  const DepthImage noisy = add_noise(step, kCamera, {NoiseModel::kKinect, 0, 5}, 0);
  const auto share_of_far = [&](int x) {
    int far = 0;
    for (int y = 0; y < noisy.height; ++y) far += noisy.at(x, y) > 7500 ? 1 : 0;
    return far / 240.0;
  };
  EXPECT_NEAR(share_of_far(159), 0.16, 0.08);  // P(offset > 0.5) with sigma 0.5
  EXPECT_NEAR(share_of_far(160), 0.84, 0.08);
  EXPECT_EQ(share_of_far(155), 0);
  EXPECT_EQ(share_of_far(165), 1);
}

TEST(DepthNoise, DependsOnSeedAndFrameOnly) {
  for (const NoiseModel model :
       {NoiseModel::kGaussian, NoiseModel::kKinect, NoiseModel::kKinectWhite}) {
    const DepthImage clean = wall(2.0);
    const DepthImage first = add_noise(clean, kCamera, {model, 0.01, 1}, 5);
    add_noise(clean, kCamera, {model, 0.01, 1}, 6);
    EXPECT_EQ(add_noise(clean, kCamera, {model, 0.01, 1}, 5), first);
    EXPECT_NE(add_noise(clean, kCamera, {model, 0.01, 1}, 6), first);
    EXPECT_NE(add_noise(clean, kCamera, {model, 0.01, 2}, 5), first);
  }
}

TEST(DepthNoise, HolesStayHolesAndNothingWrapsAround) {
  DepthImage depth = wall(2.0);
  depth.at(10, 10) = 0;
  EXPECT_EQ(add_noise(depth, kCamera, {NoiseModel::kGaussian, 0.01, 1}, 0).at(10, 10), 0);
  EXPECT_EQ(add_noise(depth, kCamera, {NoiseModel::kNone, 0.01, 1}, 0), depth);
  const DepthImage far = add_noise(wall(13.1), kCamera, {NoiseModel::kGaussian, 0.2, 1}, 0);
  EXPECT_GT(std::count(far.pixels.begin(), far.pixels.end(), 0), 1000)
      << "beyond 16 bits is no measurement";
  for (const std::uint16_t value : far.pixels) ASSERT_TRUE(value == 0 || value > 50000);
  for (const std::uint16_t value :
       add_noise(wall(0.01), kCamera, {NoiseModel::kGaussian, 0.2, 1}, 0).pixels)
    ASSERT_LT(value, 10000);
}

TEST(DepthNoise, OptionsAreParsedWithTheirRanges) {
  EXPECT_EQ(*parse_noise("none"), (NoiseOptions{NoiseModel::kNone, 0.003, 1}));
  EXPECT_EQ(*parse_noise("kinect,seed=9"), (NoiseOptions{NoiseModel::kKinect, 0.003, 9}));
  EXPECT_EQ(*parse_noise("kinect-white"), (NoiseOptions{NoiseModel::kKinectWhite, 0.003, 1}));
  EXPECT_EQ(*parse_noise("gaussian,sigma_mm=6,seed=2"),
            (NoiseOptions{NoiseModel::kGaussian, 0.006, 2}));
  EXPECT_THAT(parse_noise("pink").error().message,
              HasSubstr("allowed is none, gaussian, kinect or kinect-white"));
  EXPECT_THAT(parse_noise("gaussian,sigma_mm=201").error().message,
              HasSubstr("allowed is a number from 0 to 200"));
  EXPECT_THAT(parse_noise("kinect,sigma_mm=3").error().message,
              HasSubstr("noise kinect: there is no option \"sigma_mm\""));
  EXPECT_THAT(parse_noise("kinect,steps_per_px=0").error().message,
              HasSubstr("option steps_per_px"));
  EXPECT_THAT(parse_noise("gaussian,steps_per_px=4").error().message,
              HasSubstr("there is no option \"steps_per_px\""));
  EXPECT_FALSE(parse_noise("").ok());
  EXPECT_FALSE(parse_noise("kinect,seed=-1").ok());
}

}  // namespace
}  // namespace hermite::disturb
