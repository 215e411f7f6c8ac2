#include "core/disturb/shutter_disturbance.h"
#include "core/source/open_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hermite::disturb {
namespace {

using testing::HasSubstr;

// Twice a hand's usual speed. Frame 3 is at 0.1 s, and what is due then and 10 ms around it is
// rendered by a faster camera.
const std::string kWalked = "synthetic:speed=2,width=320,height=240,frames=7";
constexpr std::int64_t kFrame = 3;
const std::string kFaster = "synthetic:speed=2,width=320,height=240,rate=100,frames=20";
constexpr double kUnits_per_m = 5000;

frame::RgbdFrame frame_of(const std::string& source, std::int64_t index) {
  return *dataset::decode_frame(*(*source::open_sequence(source))->read(index));
}

// Left and right: there, and in the outermost rows, is what the frame does not show.
constexpr int kBorder_px = 10;

// Returns the share of the pixels of the rows [first, last) whose depth differs by less than a
// hundredth; those without depth do not agree.
double agreeing_share(const DepthImage& a, const DepthImage& b, int first, int last) {
  int agreeing = 0;
  for (int y = first; y < last; ++y)
    for (int x = kBorder_px; x < a.width - kBorder_px; ++x)
      agreeing += a.at(x, y) > 0 && std::abs(a.at(x, y) - b.at(x, y)) < 0.01 * b.at(x, y) ? 1 : 0;
  return agreeing / ((a.width - 2.0 * kBorder_px) * (last - first));
}

double median_depth_error_m(const DepthImage& a, const DepthImage& b, int first, int last) {
  std::vector<double> errors_m;
  for (int y = first; y < last; ++y)
    for (int x = kBorder_px; x < a.width - kBorder_px; ++x)
      errors_m.push_back(std::abs(a.at(x, y) - b.at(x, y)) / kUnits_per_m);
  std::nth_element(errors_m.begin(),
                   errors_m.begin() + static_cast<std::ptrdiff_t>(errors_m.size() / 2),
                   errors_m.end());
  return errors_m[errors_m.size() / 2];
}

double mean_color_error(const ColorImage& a, const ColorImage& b, int first, int last) {
  double sum = 0;
  for (int y = first; y < last; ++y)
    for (int x = kBorder_px; x < a.width - kBorder_px; ++x)
      sum += std::abs(a.at(x, y).g - b.at(x, y).g);
  return sum / ((a.width - 2 * kBorder_px) * (last - first));
}

TEST(ShutterDisturbance, EachRowOfARollingShutterIsSeenAtItsTime) {
  const frame::RgbdFrame rolled = frame_of(kWalked + "+rolling=ms=20", kFrame),
                         still = frame_of(kWalked, kFrame);
  const frame::RgbdFrame before = frame_of(kFaster, 9), after = frame_of(kFaster, 11);
  // Over ten rows the camera moves on by a twelfth of 10 ms.
  for (const auto& [there, first, last] :
       {std::tuple(&before, 3, 10), std::tuple(&after, 230, 237), std::tuple(&still, 118, 122)}) {
    EXPECT_GT(agreeing_share(rolled.depth, there->depth, first, last), 0.98) << first;
    EXPECT_LT(median_depth_error_m(rolled.depth, there->depth, first, last), 0.0006) << first;
  }
  EXPECT_GT(median_depth_error_m(still.depth, before.depth, 0, 10), 0.003)
      << "the camera moves enough to tell";
  EXPECT_LT(mean_color_error(rolled.color, before.color, 0, 10),
            0.5 * mean_color_error(still.color, before.color, 0, 10));
  EXPECT_LT(mean_color_error(rolled.color, after.color, 230, 240),
            0.5 * mean_color_error(still.color, after.color, 230, 240));
}

TEST(ShutterDisturbance, AShutterWithoutDurationChangesNoDepth) {
  EXPECT_EQ(frame_of(kWalked + "+rolling=ms=0", kFrame).depth, frame_of(kWalked, kFrame).depth);
}

TEST(ShutterDisturbance, LateColourIsThatOfLaterAndDepthStays) {
  const frame::RgbdFrame now = frame_of(kWalked, kFrame),
                         late = frame_of(kWalked + "+clock=ms=10", kFrame);
  const frame::RgbdFrame early = frame_of(kWalked + "+clock=ms=-10", kFrame),
                         by_two = frame_of(kWalked + "+clock=ms=60", kFrame);
  EXPECT_EQ(late.depth, now.depth);
  const auto is_of = [](const frame::RgbdFrame& frame, std::int64_t faster_frame,
                        std::int64_t other_frame) {
    const double here =
        mean_color_error(frame.color, frame_of(kFaster, faster_frame).color, 5, 235);
    EXPECT_LT(here,
              0.4 * mean_color_error(frame.color, frame_of(kFaster, other_frame).color, 5, 235))
        << faster_frame;
  };
  is_of(late, 11, 10);
  is_of(early, 9, 10);
  is_of(by_two, 16, 17);  // made of frame 5, 7 ms later, not of frame 3
  is_of(by_two, 16, 15);
}

TEST(ShutterDisturbance, ABlurredImageIsTheMeanOfItsExposure) {
  const frame::RgbdFrame sharp = frame_of(kWalked, kFrame),
                         blurred = frame_of(kWalked + "+blur=ms=40", kFrame);
  EXPECT_EQ(blurred.depth, sharp.depth);
  ColorImage mean = sharp.color;
  std::vector<ColorImage> views;
  for (std::int64_t i = 8; i <= 12; ++i) views.push_back(frame_of(kFaster, i).color);
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    // By the trapezium's rule.
    const double sum = 0.5 * views[0].pixels[i].g + views[1].pixels[i].g + views[2].pixels[i].g +
                       views[3].pixels[i].g + 0.5 * views[4].pixels[i].g;
    mean.pixels[i].g = static_cast<std::uint8_t>(std::lround(sum / 4));
  }
  EXPECT_LT(mean_color_error(blurred.color, mean, 10, 230),
            0.4 * mean_color_error(sharp.color, mean, 10, 230));
}

TEST(ShutterDisturbance, FramesAndPosesStayWhatTheyAre) {
  const auto plain = *source::open_sequence(kWalked),
             changed = *source::open_sequence(kWalked + "+rolling+clock+blur");
  EXPECT_EQ(changed->frame_count(), plain->frame_count());
  EXPECT_EQ(changed->timestamp_s(kFrame), plain->timestamp_s(kFrame));
  EXPECT_EQ(changed->groundtruth()[kFrame].world_from_camera.translation,
            plain->groundtruth()[kFrame].world_from_camera.translation);
  EXPECT_EQ(changed->read(kFrame)->color_bytes,
            (*source::open_sequence(kWalked + "+rolling=ms=30+clock=ms=16+blur=ms=15"))
                ->read(kFrame)
                ->color_bytes);
}

TEST(ShutterDisturbance, NonsenseIsAnErrorWithAMessage) {
  const auto error_of = [](const std::string& suffix) {
    const auto opened = source::open_sequence(kWalked + suffix);
    return opened.ok() ? "opened" : opened.error().message;
  };
  EXPECT_THAT(error_of("+rolling=ms=101"),
              HasSubstr("rolling: option ms is \"101\", allowed is a number from 0 to 100"));
  EXPECT_THAT(error_of("+clock=ms=-101"),
              HasSubstr("clock: option ms is \"-101\", allowed is a number from -100 to 100"));
  EXPECT_THAT(error_of("+blur=ms=-1"),
              HasSubstr("blur: option ms is \"-1\", allowed is a number from 0 to 100"));
  EXPECT_THAT(error_of("+blur=length=3"), HasSubstr("blur: there is no option \"length\""));
}

}  // namespace
}  // namespace hermite::disturb
