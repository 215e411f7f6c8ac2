#include "core/disturb/light_disturbance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/disturb/true_view.h"
#include "core/source/open_sequence.h"

namespace hermite::disturb::light_disturbance_test {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr int kWidth = 96, kHeight = 72;
constexpr std::int64_t kMiddle = 20;
const std::string kSource = "synthetic:frames=40,rate=10,width=96,height=72";

struct Seen {
  frame::RgbdFrame plain, disturbed;
  Camera camera;

  double depth_m(int x, int y) const { return plain.depth.at(x, y) / camera.depth_units_per_metre; }

  // The gain over all pixels of which `is_of` is true, by the sum of the greens; of pixels that do
  // not saturate.
  double gain(const std::function<bool(int x, int y)>& is_of) const {
    double before = 0, after = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        if (plain.depth.at(x, y) == 0 || plain.color.at(x, y).g > 130 || !is_of(x, y)) continue;
        before += plain.color.at(x, y).g;
        after += disturbed.color.at(x, y).g;
      }
    EXPECT_GT(before, 300) << "too few pixels to tell";
    return after / before;
  }
};

Seen see(const std::string& suffix, std::int64_t index) {
  const auto room = *source::open_sequence(kSource);
  const auto changed = source::open_sequence(kSource + suffix);
  EXPECT_TRUE(changed.ok()) << changed.error().message;
  Seen seen{*dataset::decode_frame(*room->read(index)),
            *dataset::decode_frame(*(*changed)->read(index)), room->camera()};
  EXPECT_EQ(seen.disturbed.depth, seen.plain.depth);
  return seen;
}

std::string error_of(const std::string& suffix) {
  const auto opened = source::open_sequence(kSource + suffix);
  return opened.ok() ? "opened" : opened.error().message;
}

TEST(LightDisturbance, AHeadlampLightsWhatIsNear) {
  const Seen seen = see("+headlamp=ambient=0,reference_m=1.5", kMiddle);
  const auto lit_at = [&](double from_m, double to_m) {
    return seen.gain([&](int x, int y) {
      return x > 30 && x < 66 && seen.depth_m(x, y) > from_m && seen.depth_m(x, y) < to_m;
    });
  };
  const double middle = lit_at(2.0, 2.3), far = lit_at(2.8, 3.2);
  EXPECT_NEAR(middle / far, std::pow(3.0 / 2.15, 2), 0.3);
}

TEST(LightDisturbance, ALampGoesOutOnTheLeft) {
  const auto side = [](const Seen& seen, bool is_left) {
    return seen.gain([&](int x, int y) {
      return (is_left ? kWidth / 2 - 0.5 - x : x - kWidth / 2 + 0.5) * seen.depth_m(x, y) / 80 >
             0.5;
    });
  };
  const Seen before = see("+lamp=at_s=2.05,dim=0.3", kMiddle),
             after = see("+lamp=at_s=1.95,dim=0.3", kMiddle);
  EXPECT_NEAR(side(before, true), 1, 0.02);
  EXPECT_NEAR(side(after, true), 0.3, 0.05);
  EXPECT_NEAR(side(after, false), 1, 0.05);
}

TEST(LightDisturbance, ASpotOfSunWandersOverTheSurfaces) {
  const std::string sun = "+sun=gain=1.6,width_m=0.6,speed_m_s=0.5";
  const auto is_in_the_middle = [](int x, int y) {
    return std::abs(x - kWidth / 2) < 5 && std::abs(y - kHeight / 2) < 5;
  };
  EXPECT_NEAR(see(sun, kMiddle).gain(is_in_the_middle), 1.6, 0.08);
  EXPECT_NEAR(see(sun, kMiddle).gain([](int x, int /*y*/) { return x < kWidth / 4; }), 1, 0.02);
  EXPECT_NEAR(see(sun, 0).gain([](int x, int /*y*/) { return x > kWidth / 2; }), 1, 0.02)
      << "it comes from the left";
}

TEST(LightDisturbance, TheWhiteBalanceSwingsBetweenRedAndBlue) {
  const Seen seen = see("+balance=amplitude=0.2,period_s=8", kMiddle);  // a quarter of the period
  double red = 0, green = 0, blue = 0, red_before = 0, green_before = 0, blue_before = 0;
  for (std::size_t i = 0; i < seen.plain.color.pixels.size(); ++i) {
    const Rgb8 &before = seen.plain.color.pixels[i], &after = seen.disturbed.color.pixels[i];
    if (before.r > 200) continue;
    red += after.r, green += after.g, blue += after.b;
    red_before += before.r, green_before += before.g, blue_before += before.b;
  }
  EXPECT_NEAR(red / red_before, 1.2, 0.02);
  EXPECT_NEAR(green / green_before, 1, 0.02);
  EXPECT_NEAR(blue / blue_before, 0.8, 0.02);
}

TEST(LightDisturbance, NonsenseIsAnErrorWithAMessage) {
  EXPECT_THAT(error_of("+headlamp=ambient=2"), HasSubstr("headlamp: option ambient is \"2\""));
  EXPECT_THAT(error_of("+lamp=dim=-1"), HasSubstr("lamp: option dim"));
  EXPECT_THAT(error_of("+sun=gain=0.5"), HasSubstr("sun: option gain"));
  EXPECT_THAT(error_of("+balance=period=3"), HasSubstr("balance: there is no option \"period\""));
}

}  // namespace
}  // namespace hermite::disturb::light_disturbance_test
