#include "core/synthetic/room_textures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::synthetic {
namespace {

using Eigen::Vector3f;

Material material_of(int pattern) {
  return {static_cast<Pattern>(pattern), linear_from_srgb(0xd0a070), linear_from_srgb(0x304060), 0,
          5};
}

constexpr int kPatternCount = static_cast<int>(Pattern::kScreen) + 1;

// Spread of brightness over a face, looked at with pixels of this size.
float contrast(const Material& material, float footprint_m) {
  float sum = 0, sum2 = 0;
  constexpr int kSide = 60;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const float u = 0.0131f * static_cast<float>(x) - 0.4f,
                  v = 0.0097f * static_cast<float>(y) - 0.29f;
      const float value = texture_color(material, {u, v, 0.5f, 0.5f, footprint_m, 1}).mean();
      sum += value;
      sum2 += value * value;
    }
  const float count = kSide * kSide;
  return std::sqrt(std::max(0.0f, sum2 / count - (sum / count) * (sum / count)));
}

TEST(RoomTextures, AreBoundedDeterministicAndNotFlat) {
  for (int pattern = 0; pattern < kPatternCount; ++pattern) {
    const Material material = material_of(pattern);
    EXPECT_GT(contrast(material, 0.002f), 0.004f)
        << pattern << ": a tracker needs something to see";
    for (int i = 0; i < 2000; ++i) {
      const TexturePoint point{0.37f * std::sin(static_cast<float>(i)),
                               0.41f * std::cos(3.0f * static_cast<float>(i)),
                               0.5f,
                               0.4f,
                               0.003f,
                               i % 6};
      const Vector3f color = texture_color(material, point);
      ASSERT_TRUE(color.allFinite()) << pattern;
      ASSERT_GE(color.minCoeff(), 0) << pattern;
      ASSERT_LE(color.maxCoeff(), 1.6f) << pattern;
      ASSERT_EQ(color, texture_color(material, point)) << pattern;
    }
  }
}

TEST(RoomTextures, FineDetailFadesBeforeItAliases) {
  for (const Pattern pattern :
       {Pattern::kPlaster, Pattern::kFabric, Pattern::kTiles, Pattern::kLeaves, Pattern::kMetal}) {
    const Material material = material_of(static_cast<int>(pattern));
    EXPECT_LT(contrast(material, 0.5f), 0.5f * contrast(material, 0.001f))
        << static_cast<int>(pattern);
  }
}

TEST(RoomTextures, DegenerateFootprintsAndFacesGiveNumbers) {
  for (int pattern = 0; pattern < kPatternCount; ++pattern)
    for (const float footprint_m : {0.0f, 1e-6f, 10.0f})
      EXPECT_TRUE(texture_color(material_of(pattern), {0.1f, 0.1f, 0.005f, 0.005f, footprint_m, 0})
                      .allFinite())
          << pattern << " " << footprint_m;
}

TEST(RoomTextures, SrgbBecomesLinear) {
  EXPECT_TRUE(linear_from_srgb(0xff0000).isApprox(Vector3f(1, 0, 0)));
  EXPECT_NEAR(linear_from_srgb(0x808080).y(), 0.2158f, 1e-3f);
  EXPECT_NEAR(linear_from_srgb(0x000001).z(), 1 / 255.0f / 12.92f, 1e-6f);
}

}  // namespace
}  // namespace hermite::synthetic
