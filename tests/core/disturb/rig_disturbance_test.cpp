#include "core/disturb/rig_disturbance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/source/open_sequence.h"

namespace hermite::disturb::rig_disturbance_test {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 96, kHeight = 72;
const std::string kSource = "synthetic:frames=20,rate=10,width=96,height=72";

std::unique_ptr<dataset::Sequence> opened(const std::string& suffix) {
  auto sequence = source::open_sequence(kSource + suffix);
  EXPECT_TRUE(sequence.ok()) << sequence.error().message;
  return std::move(*sequence);
}

frame::RgbdFrame frame_of(const std::string& suffix, std::int64_t index) {
  return *dataset::decode_frame(*opened(suffix)->read(index));
}

std::string error_of(const std::string& suffix) {
  const auto sequence = source::open_sequence(kSource + suffix);
  return sequence.ok() ? "opened" : sequence.error().message;
}

TEST(RigDisturbance, APartOfTheRigStaysInItsCorner) {
  const frame::RgbdFrame first = frame_of("+attached=share=0.2,distance_m=0.6", 2),
                         second = frame_of("+attached=share=0.2,distance_m=0.6", 15);
  const DepthImage plain = frame_of("", 2).depth;
  const double units = opened("")->camera().depth_units_per_metre;
  int attached = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (first.depth.at(x, y) == plain.at(x, y)) continue;
      ++attached;
      EXPECT_EQ(first.depth.at(x, y), second.depth.at(x, y));
      EXPECT_NEAR(first.depth.at(x, y) / units, 0.6, 0.13);
      EXPECT_GT(x + y, kHeight / 2) << "lower right";
    }
  EXPECT_NEAR(attached, 0.2 * kWidth * kHeight, 0.02 * kWidth * kHeight);
}

TEST(RigDisturbance, BelowItsSeamATornFrameShowsTheOneBefore) {
  std::vector<int> seams;
  for (const std::int64_t index : {4, 8, 12}) {
    const DepthImage torn = frame_of("+torn=every=4", index).depth, own = frame_of("", index).depth,
                     before = frame_of("", index - 1).depth;
    int seam = 0;
    const auto row = [](const DepthImage& image, int y) {
      return std::vector(image.pixels.begin() + y * kWidth,
                         image.pixels.begin() + (y + 1) * kWidth);
    };
    while (seam < kHeight && row(torn, seam) == row(own, seam)) ++seam;
    for (int y = seam; y < kHeight; ++y) EXPECT_EQ(row(torn, y), row(before, y)) << y;
    seams.push_back(seam);
  }
  EXPECT_NE(seams[0], seams[1]);
  EXPECT_EQ(frame_of("+torn=every=4", 5).depth, frame_of("", 5).depth);
  EXPECT_EQ(frame_of("+torn=every=4", 0).depth, frame_of("", 0).depth);
}

TEST(RigDisturbance, StainsHideTheSamePixelsOfAllFrames) {
  const std::string stained = "+stained=spots=3,width_px=16";
  const DepthImage first = frame_of(stained, 1).depth, plain = frame_of("", 1).depth,
                   later = frame_of(stained, 11).depth;
  int hidden = 0;
  for (std::size_t i = 0; i < first.pixels.size(); ++i) {
    if (first.pixels[i] == plain.pixels[i]) continue;
    ++hidden;
    EXPECT_EQ(first.pixels[i], 0);
    EXPECT_EQ(later.pixels[i], 0);
  }
  EXPECT_GT(hidden, 200);
  EXPECT_LT(hidden, 3 * 210) << "three discs of 16 pixels";
}

TEST(RigDisturbance, AWarmingSensorMeasuresEverFarther) {
  const auto factor = [](std::int64_t index) {
    const DepthImage warm = frame_of("+warming=percent=2,over_s=1", index).depth,
                     plain = frame_of("", index).depth;
    double sum = 0, sum_before = 0;
    for (std::size_t i = 0; i < warm.pixels.size(); ++i)
      sum += warm.pixels[i], sum_before += plain.pixels[i];
    return sum / sum_before;
  };
  EXPECT_NEAR(factor(0), 1, 1e-6);
  EXPECT_NEAR(factor(5), 1.01, 2e-4);
  EXPECT_NEAR(factor(15), 1.02, 2e-4) << "constant from then on";
}

TEST(RigDisturbance, StampsOfArrivalAreLateAndTheTruthGoesWithThem) {
  const auto plain = opened(""), late = opened("+jitter=ms=150");
  double latest_s = 0;
  for (std::int64_t i = 0; i < 20; ++i) {
    const double late_s = late->timestamp_s(i) - plain->timestamp_s(i);
    latest_s = std::max(latest_s, late_s);
    EXPECT_GE(late_s, 0);
    EXPECT_GT(late->timestamp_s(i), i > 0 ? late->timestamp_s(i - 1) : -1);
    EXPECT_EQ(late->read(i)->timestamp_s, late->timestamp_s(i));
    const auto pose = dataset::pose_at(late->groundtruth(), late->timestamp_s(i), 0.01),
               own = dataset::pose_at(plain->groundtruth(), plain->timestamp_s(i), 0.01);
    EXPECT_LT((pose->translation - own->translation).norm(), 1e-9);
  }
  EXPECT_GT(latest_s, 0.1);
  EXPECT_LE(latest_s, 0.16);
}

TEST(RigDisturbance, NonsenseIsAnErrorWithAMessage) {
  EXPECT_THAT(error_of("+attached=share=0.6"), HasSubstr("attached: option share is \"0.6\""));
  EXPECT_THAT(error_of("+torn=every=0"), HasSubstr("torn: option every"));
  EXPECT_THAT(error_of("+stained=spots=0"), HasSubstr("stained: option spots"));
  EXPECT_THAT(error_of("+warming=percent=11"), HasSubstr("warming: option percent"));
  EXPECT_THAT(error_of("+jitter=ms=-1"), HasSubstr("jitter: option ms"));
}

}  // namespace
}  // namespace hermite::disturb::rig_disturbance_test
