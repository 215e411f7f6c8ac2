#include "core/disturb/sensor_disturbance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/image/image_codec.h"
#include "core/source/open_sequence.h"

namespace hermite::disturb::sensor_disturbance_test {
namespace {

using testing::HasSubstr;

const std::string kSource = "synthetic:frames=20,width=96,height=72";

DepthImage depth_of(const std::string& suffix, std::int64_t index) {
  return (*source::open_sequence(kSource + suffix))->read(index)->depth;
}

ColorImage color_of(const std::string& suffix, std::int64_t index) {
  return *image::decode_color((*source::open_sequence(kSource + suffix))->read(index)->color_bytes,
                              {96, 72});
}

std::string error_of(const std::string& suffix) {
  const auto opened = source::open_sequence(kSource + suffix);
  return opened.ok() ? "opened" : opened.error().message;
}

double mean_green(const ColorImage& color, int first_row, int last_row) {
  double sum = 0;
  for (int y = first_row; y < last_row; ++y)
    for (int x = 0; x < color.width; ++x) sum += color.at(x, y).g;
  return sum / ((last_row - first_row) * color.width);
}

TEST(SensorDisturbance, FlyingDepthLiesBetweenBothSidesOfAnEdge) {
  const DepthImage sharp = depth_of("", 3), flying = depth_of("+flying=width_px=1", 3);
  int flown = 0;
  for (int y = 1; y < 71; ++y)
    for (int x = 1; x < 95; ++x) {
      if (flying.at(x, y) == sharp.at(x, y)) continue;
      ++flown;
      bool is_between = false;
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
        is_between = is_between ||
                     std::abs(2 * flying.at(x, y) - sharp.at(x, y) - sharp.at(x + dx, y + dy)) <= 1;
      EXPECT_TRUE(is_between) << x << " " << y;
    }
  EXPECT_GT(flown, 20);
  EXPECT_LT(flown, 96 * 72 / 4) << "edges alone";
}

TEST(SensorDisturbance, CoarseDepthIsMeasuredAtSomePixelsAndStraightBetween) {
  const DepthImage fine = depth_of("", 3), coarse = depth_of("+lowres=every=6", 3);
  int straight = 0, all = 0;
  for (int y = 0; y < 72; y += 6)
    for (int x = 0; x + 6 < 96; x += 6) {
      EXPECT_EQ(coarse.at(x, y), fine.at(x, y));
      if (fine.at(x, y) == 0 || fine.at(x + 6, y) == 0) continue;
      ++all;
      straight +=
          std::abs(2 * coarse.at(x + 3, y) - fine.at(x, y) - fine.at(x + 6, y)) <= 1 ? 1 : 0;
    }
  EXPECT_GT(all, 100);
  EXPECT_EQ(straight, all);
}

TEST(SensorDisturbance, SpeckleTakesDepthAndInventsSome) {
  const DepthImage whole = depth_of("", 3), speckled = depth_of("+speckle=holes=0.3,wild=0.1", 3);
  double measured = 0, holes = 0, wild = 0;
  for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
    if (whole.pixels[i] == 0) continue;
    measured += 1;
    holes += speckled.pixels[i] == 0 ? 1 : 0;
    wild += speckled.pixels[i] != 0 && speckled.pixels[i] != whole.pixels[i] ? 1 : 0;
  }
  EXPECT_NEAR(holes / measured, 0.3, 0.03);
  EXPECT_NEAR(wild / measured, 0.1, 0.02);
  EXPECT_NE(depth_of("+speckle", 3), depth_of("+speckle", 4)) << "other pixels in each frame";
}

TEST(SensorDisturbance, FrozenFramesShowWhatTheOneBeforeThemDid) {
  const auto plain = *source::open_sequence(kSource),
             frozen = *source::open_sequence(kSource + "+frozen=every=5,count=2");
  const std::int64_t shown[] = {0, 1, 2, 2, 2, 5, 6, 7, 7, 7};
  for (std::int64_t i = 0; i < 10; ++i) {
    EXPECT_EQ(frozen->read(i)->depth, plain->read(shown[i])->depth) << i;
    EXPECT_EQ(frozen->read(i)->color_bytes, plain->read(shown[i])->color_bytes) << i;
    EXPECT_EQ(frozen->read(i)->timestamp_s, plain->timestamp_s(i)) << i;
  }
}

TEST(SensorDisturbance, MisregisteredColourIsBesideItsDepth) {
  const ColorImage right = color_of("", 3),
                   shifted = color_of("+misregistered=right_px=5,down_px=-3", 3);
  double off = 0, by_chance = 0;
  for (int y = 10; y < 60; ++y)
    for (int x = 10; x < 80; ++x) {
      off += std::abs(shifted.at(x + 5, y - 3).g - right.at(x, y).g);
      by_chance += std::abs(shifted.at(x, y).g - right.at(x, y).g);
    }
  EXPECT_LT(off, 0.3 * by_chance) << "a JPEG beside what was there";
  EXPECT_EQ(depth_of("+misregistered", 3), depth_of("", 3));
}

TEST(SensorDisturbance, BandsWanderThroughTheImage) {
  const auto gain = [](int first_row, std::int64_t frame) {
    return mean_green(color_of("+banding=amplitude=0.3,bands=1", frame), first_row, first_row + 6) /
           mean_green(color_of("", frame), first_row, first_row + 6);
  };
  EXPECT_NEAR(gain(15, 0), 1.3, 0.04);
  EXPECT_NEAR(gain(51, 0), 0.7, 0.04);
  EXPECT_LT(gain(15, 1), 1.0);
}

TEST(SensorDisturbance, LittleLightIsDarkAndNoisy) {
  const ColorImage bright = color_of("", 3), dark = color_of("+dark=gain=0.2,sigma=3", 3);
  EXPECT_NEAR(mean_green(dark, 0, 72), 0.2 * mean_green(bright, 0, 72), 2);
  double squares = 0;
  for (std::size_t i = 0; i < dark.pixels.size(); ++i)
    squares += std::pow(dark.pixels[i].g - 0.2 * bright.pixels[i].g, 2);
  EXPECT_GT(std::sqrt(squares / static_cast<double>(dark.pixels.size())), 1.5);
  EXPECT_NE(color_of("+dark=seed=2", 3).pixels, color_of("+dark=seed=3", 3).pixels);
}

TEST(SensorDisturbance, NonsenseIsAnErrorWithAMessage) {
  EXPECT_THAT(error_of("+flying=width_px=9"), HasSubstr("flying: option width_px is \"9\""));
  EXPECT_THAT(error_of("+lowres=every=1"), HasSubstr("lowres: option every"));
  EXPECT_THAT(error_of("+speckle=holes=0.95"), HasSubstr("speckle: option holes"));
  EXPECT_THAT(error_of("+frozen=every=3,count=3"),
              HasSubstr("frozen: count is 3, expected less than every, 3"));
  EXPECT_THAT(error_of("+misregistered=left_px=3"),
              HasSubstr("misregistered: there is no option \"left_px\""));
  EXPECT_THAT(error_of("+banding=bands=0"), HasSubstr("banding: option bands"));
  EXPECT_THAT(error_of("+dark=gain=0"), HasSubstr("dark: option gain"));
}

}  // namespace
}  // namespace hermite::disturb::sensor_disturbance_test
