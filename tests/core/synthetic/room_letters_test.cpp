#include "core/synthetic/room_letters.h"

#include <gtest/gtest.h>

#include <cstring>

namespace hermite::synthetic {
namespace {

float ink_at(float u_m, float v_m, float footprint_m) {
  return ink_of_poster({u_m, v_m, 0.41f, 0.29f, footprint_m, 2});
}

TEST(RoomLetters, StandBetweenTheirBaselineAndTheHeightOfCapitals) {
  for (const PosterLine& line : kPosterLines) {
    float lowest_m = 1, highest_m = -1, ink_m2 = 0, left_m = 1, right_m = -1;
    constexpr float kStep_m = 0.0005f;
    for (float v = line.baseline_m - 0.004f; v < line.baseline_m + line.cap_height_m + 0.004f;
         v += kStep_m)
      for (float u = -0.41f; u < 0.41f; u += kStep_m) {
        const float ink = ink_at(u, v, kStep_m);
        ink_m2 += ink * kStep_m * kStep_m;
        if (ink < 0.5f) continue;
        lowest_m = std::min(lowest_m, v);
        highest_m = std::max(highest_m, v);
        left_m = std::min(left_m, u);
        right_m = std::max(right_m, u);
      }
    const float stroke_m = line.cap_height_m * 1.6f / 12;
    EXPECT_NEAR(highest_m - lowest_m, line.cap_height_m + stroke_m, 0.0012f) << line.words;
    EXPECT_NEAR(left_m, -right_m, 0.001f) << line.words;
    EXPECT_LT(right_m, 0.38f) << "on the paper: " << line.words;
    EXPECT_GT(ink_m2 / (static_cast<float>(std::strlen(line.words)) * line.cap_height_m * stroke_m),
              1.2f)
        << "strokes of every letter";
  }
}

TEST(RoomLetters, CoarsePixelsHaveTheSameInkOnAverage) {
  const PosterLine& line = kPosterLines[0];
  const auto mean = [&](float step_m) {
    double sum = 0;
    int count = 0;
    for (float v = line.baseline_m - 0.01f; v < line.baseline_m + line.cap_height_m + 0.01f;
         v += 0.0013f)
      for (float u = -0.2f; u < 0.2f; u += 0.0013f, ++count)
        sum += static_cast<double>(ink_at(u, v, step_m));
    return sum / count;
  };
  EXPECT_NEAR(mean(0.004f), mean(0.0005f), 0.12 * mean(0.0005f));
}

// The second line begins with an A and a word that begins with an L: its upright is on the left of
// its foot.
TEST(RoomLetters, AreNotMirrored) {
  const PosterLine& line = kPosterLines[1];
  ASSERT_EQ(std::strncmp(line.words, "A LAZY", 6), 0);
  const auto first_ink_m = [&](float height, float from_m) {
    while (ink_at(from_m, line.baseline_m + height * line.cap_height_m, 0.0005f) < 0.5f &&
           from_m < 0.4f)
      from_m += 0.0005f;
    return from_m;
  };
  const float a_m = first_ink_m(0.02f, -0.41f), upright_m = first_ink_m(0.9f, a_m + 0.016f);
  EXPECT_NEAR(first_ink_m(0.0f, upright_m - 0.001f), upright_m, 0.001f);
  EXPECT_GT(ink_at(upright_m + 0.008f, line.baseline_m, 0.0005f), 0.9f) << "the foot";
  EXPECT_EQ(ink_at(upright_m + 0.006f, line.baseline_m + 0.7f * line.cap_height_m, 0.0005f), 0)
      << "nothing above it";
}

}  // namespace
}  // namespace hermite::synthetic
