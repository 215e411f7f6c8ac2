#include "core/frame/sensor_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace hermite::frame::sensor_noise_test {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr double kUnitsPerMetre = 5000;

// A tilted wall, two to three metres away, with this many of the options' standard deviations of
// noise: by pixel.
DepthImage wall(const std::function<double(int x, int y)>& deviations) {
  const FrameOptions options;
  DepthImage depth(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double depth_m = 1 / (0.5 - 0.001 * x), beyond_m = depth_m - 0.4;
      const double noise_m =
          options.noise_floor_m + options.noise_growth_per_m * beyond_m * beyond_m;
      depth.at(x, y) = static_cast<std::uint16_t>(
          std::lround((depth_m + noise_m * deviations(x, y)) * kUnitsPerMetre));
    }
  return depth;
}

// Normal deviates, each the sum over a block of independent ones.
std::vector<double> deviates(int block, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const int width = kWidth + block, height = kHeight + block;
  std::vector<double> white(static_cast<std::size_t>(width * height)), sums;
  for (double& value : white) value = normal(random);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      double sum = 0;
      for (int dy = 0; dy < block; ++dy)
        for (int dx = 0; dx < block; ++dx)
          sum += white[static_cast<std::size_t>((y + dy) * width + x + dx)];
      sums.push_back(sum / block);
    }
  return sums;
}

SensorNoise noise_of(double deviation, int block) {
  SensorNoise noise;
  for (unsigned frame = 0; frame < 5; ++frame) {
    const std::vector<double> drawn = deviates(block, frame);
    const auto at = [&](int x, int y) {
      return deviation * drawn[static_cast<std::size_t>(y * kWidth + x)];
    };
    noise.add(measure_noise(wall(at), kUnitsPerMetre, {}));
  }
  return noise;
}

TEST(SensorNoise, IsMeasuredOnWhatTheFramesShow) {
  for (const double deviation : {0.5, 1.0, 2.0})
    EXPECT_NEAR(noise_of(deviation, 1).scale(), deviation, 0.07 * deviation) << deviation;
}

TEST(SensorNoise, OfIndependentPixelsIsNotCorrelated) {
  EXPECT_LT(noise_of(1, 1).correlation(), 0.05);
}

TEST(SensorNoise, OfBlocksIsTheMoreCorrelatedTheLargerTheyAre) {
  const double of_three = noise_of(1, 3).correlation(), of_five = noise_of(1, 5).correlation();
  EXPECT_GT(of_three, 0.1);
  EXPECT_GT(of_five, of_three + 0.1);
  EXPECT_NEAR(noise_of(1, 5).scale(), 1, 0.1);
}

TEST(SensorNoise, OfARenderedWallIsNone) { EXPECT_EQ(noise_of(0, 1).scale(), 0.5); }

// Steps of depth are not noise.
TEST(SensorNoise, OverlooksEdges) {
  const std::vector<double> drawn = deviates(1, 7);
  DepthImage depth =
      wall([&](int x, int y) { return drawn[static_cast<std::size_t>(y * kWidth + x)]; });
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (x % 40 < 8) depth.at(x, y) = static_cast<std::uint16_t>(depth.at(x, y) - 1500);
  SensorNoise noise;
  noise.add(measure_noise(depth, kUnitsPerMetre, {}));
  EXPECT_LT(noise.scale(), 2.5);
  EXPECT_GT(noise.scale(), 0.9);
}

TEST(SensorNoise, IsNotKnownOfAFrameWithoutDepth) {
  for (const DepthImage& depth : {DepthImage(kWidth, kHeight), DepthImage(8, 8), DepthImage()})
    EXPECT_FALSE(measure_noise(depth, kUnitsPerMetre, {}).is_known);
  SensorNoise noise;
  noise.add({});
  EXPECT_EQ(noise.scale(), 1);
  EXPECT_EQ(noise.correlation(), 0);
}

TEST(SensorNoise, WidensTheFilter) {
  const FrameOptions options;
  const FilterWidths independent = filter_widths(options, SensorNoise{}),
                     correlated = filter_widths(options, noise_of(1, 5));
  EXPECT_EQ(independent.space_px, options.bilateral_sigma_space_px);
  EXPECT_EQ(independent.depth_deviations, options.bilateral_noise_sigmas);
  EXPECT_GT(correlated.space_px, 1.3 * independent.space_px);
  EXPECT_GT(correlated.depth_deviations, 1.3 * independent.depth_deviations);
  EXPECT_LT(filter_widths(options, noise_of(0, 1)).depth_deviations,
            0.6 * independent.depth_deviations);
  FrameOptions fixed;
  fixed.measure_noise = false;
  EXPECT_EQ(filter_widths(fixed, noise_of(1, 5)).space_px, fixed.bilateral_sigma_space_px);
}

TEST(SensorNoise, ComesBackFromBytes) {
  const SensorNoise noise = noise_of(1, 5);
  ByteWriter writer;
  noise.save(writer);
  const std::string bytes = writer.take();
  ByteReader reader(bytes);
  SensorNoise restored;
  restored.restore(reader);
  EXPECT_TRUE(reader.ok() && reader.at_end());
  EXPECT_EQ(restored.scale(), noise.scale());
  EXPECT_EQ(restored.correlation(), noise.correlation());
  const std::string negative(bytes.size(), '\xff');
  ByteReader damaged(negative);
  restored.restore(damaged);
  EXPECT_FALSE(damaged.ok());
}

}  // namespace
}  // namespace hermite::frame::sensor_noise_test
