#include "core/disturb/depth_disturbance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/disturb/color_disturbance.h"
#include "core/source/open_sequence.h"

namespace hermite::disturb::depth_disturbance_test {
namespace {

using testing::HasSubstr;

const std::string kSource = "synthetic:frames=10,width=96,height=72";

DepthImage depth_of(const std::string& suffix, std::int64_t index) {
  return (*source::open_sequence(kSource + suffix))->read(index)->depth;
}

std::string error_of(const std::string& suffix) {
  const auto opened = source::open_sequence(kSource + suffix);
  return opened.ok() ? "opened" : opened.error().message;
}

TEST(DepthDisturbance, ABendGrowsTowardsTheCorners) {
  const DepthImage straight = depth_of("", 3), bent = depth_of("+bend=percent=2", 3);
  for (int y = 0; y < 72; ++y)
    for (int x = 0; x < 96; ++x)
      EXPECT_NEAR(bent.at(x, y), straight.at(x, y) * (1 + 0.02 * squared_radius(x, y, 96, 72)),
                  0.51)
          << x << " " << y;
  EXPECT_EQ(depth_of("+bend", 3), depth_of("+bend=percent=1.5", 3));
}

TEST(DepthDisturbance, SparseDepthLiesWhereTheImageHasTexture) {
  const DepthImage whole = depth_of("", 4), sparse = depth_of("+sparse=keep=0.2", 4);
  const auto count = [](const DepthImage& depth) {
    return static_cast<double>(std::count_if(depth.pixels.begin(), depth.pixels.end(),
                                             [](std::uint16_t d) { return d > 0; }));
  };
  EXPECT_NEAR(count(sparse) / count(whole), 0.2, 0.01);
  int lonely = 0;
  for (int y = 1; y < 71; ++y)
    for (int x = 1; x < 95; ++x) {
      if (sparse.at(x, y) == 0) continue;
      EXPECT_EQ(sparse.at(x, y), whole.at(x, y));
      lonely += sparse.at(x - 1, y) == 0 && sparse.at(x + 1, y) == 0 && sparse.at(x, y - 1) == 0 &&
                        sparse.at(x, y + 1) == 0
                    ? 1
                    : 0;
    }
  EXPECT_LT(lonely, 0.01 * count(sparse)) << "in blobs";
}

TEST(DepthDisturbance, DepthBeyondTheReachIsMissing) {
  const DepthImage whole = depth_of("", 4), reached = depth_of("+reach=min_m=1.8,max_m=2.5", 4);
  const double units = (*source::open_sequence(kSource))->camera().depth_units_per_metre;
  int missing = 0;
  for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
    const double depth_m = whole.pixels[i] / units;
    const bool is_reached = depth_m >= 1.8 && depth_m <= 2.5;
    EXPECT_EQ(reached.pixels[i], is_reached ? whole.pixels[i] : 0);
    missing += is_reached ? 0 : 1;
  }
  EXPECT_GT(missing, 100);
  EXPECT_LT(missing, 96 * 72 - 100);
}

TEST(DepthDisturbance, AnotherFocalLengthIsOnlySaid) {
  const auto plain = *source::open_sequence(kSource),
             refocused = *source::open_sequence(kSource + "+focal=percent=-2");
  EXPECT_DOUBLE_EQ(refocused->camera().fx, 0.98 * plain->camera().fx);
  EXPECT_DOUBLE_EQ(refocused->camera().fy, 0.98 * plain->camera().fy);
  EXPECT_EQ(refocused->camera().cx, plain->camera().cx);
  EXPECT_EQ(refocused->read(2)->depth, plain->read(2)->depth);
}

TEST(DepthDisturbance, SkippedFramesAreNotThere) {
  const auto plain = *source::open_sequence(kSource),
             skipping = *source::open_sequence(kSource + "+skip=every=4");
  ASSERT_EQ(skipping->frame_count(), 3);
  EXPECT_EQ(skipping->timestamp_s(2), plain->timestamp_s(8));
  EXPECT_EQ(skipping->read(2)->depth, plain->read(8)->depth);
  EXPECT_EQ(skipping->frame_rate_hz(), plain->frame_rate_hz() / 4);
  EXPECT_EQ(skipping->groundtruth().size(), plain->groundtruth().size());
}

TEST(DepthDisturbance, NonsenseIsAnErrorWithAMessage) {
  EXPECT_THAT(error_of("+bend=percent=11"), HasSubstr("bend: option percent is \"11\""));
  EXPECT_THAT(error_of("+sparse=keep=0"), HasSubstr("sparse: option keep"));
  EXPECT_THAT(error_of("+reach=min_m=11"), HasSubstr("reach: option min_m"));
  EXPECT_THAT(error_of("+focal=length=3"), HasSubstr("focal: there is no option \"length\""));
  EXPECT_THAT(error_of("+skip=every=1"), HasSubstr("skip: option every"));
}

}  // namespace
}  // namespace hermite::disturb::depth_disturbance_test
