#include "core/disturb/color_disturbance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "core/dataset/changed_sequence.h"
#include "core/image/image_codec.h"
#include "core/source/open_sequence.h"

namespace hermite::disturb::color_disturbance_test {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 96, kHeight = 72, kGrey = 120;
const std::string kSource = "synthetic:frames=61,width=96,height=72,scene=bare";

// Grey images, so that a pixel tells the gain.
class Grey : public dataset::ChangedSequence {
 public:
  Grey() : dataset::ChangedSequence(*source::open_sequence(kSource)) {
    ColorImage grey(kWidth, kHeight);
    std::fill(grey.pixels.begin(), grey.pixels.end(), Rgb8{kGrey, kGrey, kGrey});
    color_ = *image::encode_png(grey);
  }
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    return dataset::RecordedFrame{timestamp_s(index), DepthImage(kWidth, kHeight), color_};
  }

 private:
  std::vector<std::uint8_t> color_;
};

ColorImage color_of(const dataset::Sequence& sequence, std::int64_t index) {
  return dataset::decode_frame(*sequence.read(index))->color;
}

double gain_of(const dataset::Sequence& sequence, std::int64_t index, int x = kWidth / 2,
               int y = kHeight / 2) {
  return color_of(sequence, index).at(x, y).g / static_cast<double>(kGrey);
}

std::string error_of(const std::string& suffix) {
  const auto opened = source::open_sequence(kSource + suffix);
  return opened.ok() ? "opened" : opened.error().message;
}

constexpr double kByte = 1.6 / kGrey;  // rounding, and what the JPEG makes of a flat image

TEST(ColorDisturbance, ExposureIsASineOfTime) {
  const auto exposed = *with_exposure(std::make_unique<Grey>(), "");
  EXPECT_NEAR(gain_of(*exposed, 0), 1, kByte);
  EXPECT_NEAR(gain_of(*exposed, 15), 1.25, kByte) << "a quarter of two seconds";
  EXPECT_NEAR(gain_of(*exposed, 30), 1, kByte);
  EXPECT_NEAR(gain_of(*exposed, 45), 0.75, kByte);
  const auto fast = *with_exposure(std::make_unique<Grey>(), "amplitude=0.5,period_s=1");
  EXPECT_NEAR(gain_of(*fast, 5), 1 + 0.5 * std::sin(M_PI / 3), kByte);
}

TEST(ColorDisturbance, TooBrightIsCut) {
  const auto bright =
      *with_exposure(*with_exposure(std::make_unique<Grey>(), "amplitude=0.9"), "amplitude=0.9");
  EXPECT_EQ(color_of(*bright, 15).at(3, 3), (Rgb8{255, 255, 255}));
}

TEST(ColorDisturbance, FlickerIsAnEvenlySpreadGainOfEachFrame) {
  const auto flickering = *with_flicker(std::make_unique<Grey>(), "amplitude=0.2,seed=3");
  double least = 2, greatest = 0, sum = 0;
  for (std::int64_t i = 0; i < 61; ++i) {
    const double gain = gain_of(*flickering, i);
    least = std::min(least, gain);
    greatest = std::max(greatest, gain);
    sum += gain;
  }
  EXPECT_NEAR(least, 0.8, 0.03);
  EXPECT_NEAR(greatest, 1.2, 0.03);
  EXPECT_NEAR(sum / 61, 1, 4 * 0.2 / std::sqrt(3 * 61)) << "four standard errors";
  const auto other = *with_flicker(std::make_unique<Grey>(), "amplitude=0.2,seed=4");
  EXPECT_NE(gain_of(*other, 7), gain_of(*flickering, 7));
}

TEST(ColorDisturbance, VignettingDarkensTheCorners) {
  const auto dark = *with_vignetting(std::make_unique<Grey>(), "");
  EXPECT_NEAR(gain_of(*dark, 0), 1, kByte);
  for (const int x : {0, kWidth - 1})
    for (const int y : {0, kHeight - 1})
      EXPECT_NEAR(gain_of(*dark, 0, x, y), 0.55, 2 * kByte) << x << " " << y;
  EXPECT_EQ(squared_radius(0, 0, kWidth, kHeight), 1);
  EXPECT_NEAR(gain_of(*dark, 0, 0, kHeight / 2),
              1 - 0.45 * squared_radius(0, kHeight / 2, kWidth, kHeight), 2 * kByte);
}

TEST(ColorDisturbance, OnlyTheColourChangesAndFramesComeInAnyOrder) {
  const auto clean = *source::open_sequence(kSource),
             changed = *source::open_sequence(kSource +
                                              "+exposure=period_s=3+flicker+vignetting=corner=0.7");
  std::vector<std::uint8_t> from_thread;
  const auto late = changed->read(40);
  std::thread([&] { from_thread = changed->read(7)->color_bytes; }).join();
  const auto early = changed->read(7);
  EXPECT_EQ(early->color_bytes, from_thread);
  EXPECT_EQ(early->color_bytes,
            (*source::open_sequence(kSource + "+exposure=period_s=3+flicker+vignetting=corner=0.7"))
                ->read(7)
                ->color_bytes);
  EXPECT_EQ(late->depth, clean->read(40)->depth);
  EXPECT_EQ(late->timestamp_s, clean->timestamp_s(40));
  EXPECT_EQ(changed->camera(), clean->camera());
  EXPECT_EQ(changed->groundtruth().size(), clean->groundtruth().size());
}

TEST(ColorDisturbance, OptionsMayBeLeftOut) {
  const auto with_defaults = [](const std::string& suffix) {
    return (*source::open_sequence(kSource + suffix))->read(9)->color_bytes;
  };
  EXPECT_EQ(with_defaults("+exposure"), with_defaults("+exposure=amplitude=0.25,period_s=2"));
  EXPECT_EQ(with_defaults("+flicker"), with_defaults("+flicker=seed=1,amplitude=0.1"));
  EXPECT_EQ(with_defaults("+vignetting="), with_defaults("+vignetting=corner=0.55"));
  EXPECT_EQ(with_defaults("+flicker+covered=9:1"), with_defaults("+covered=9:1"));
  EXPECT_EQ(source::source_without_suffixes("synthetic+flicker+exposure=amplitude=0.1+vignetting"),
            "synthetic");
}

TEST(ColorDisturbance, NonsenseIsAnErrorWithAMessage) {
  EXPECT_THAT(error_of("+exposure=amplitude=1"),
              HasSubstr("exposure: option amplitude is \"1\", allowed is a number from 0 to 0.9"));
  EXPECT_THAT(error_of("+exposure=period_s=0"), HasSubstr("from 0.01 to 3600"));
  EXPECT_THAT(error_of("+flicker=sed=1"), HasSubstr("flicker: there is no option \"sed\""));
  EXPECT_THAT(error_of("+vignetting=corner"), HasSubstr("vignetting: \"corner\" is not key=value"));
  EXPECT_THAT(error_of("+flickering"), HasSubstr("bare+flickering"));
  EXPECT_THAT(error_of("+covered"), HasSubstr("is no FROM:COUNT"));
}

TEST(ColorDisturbance, ADamagedImageIsAnErrorOfItsFrame) {
  class Damaged : public Grey {
   public:
    Result<dataset::RecordedFrame> read(std::int64_t index) const override {
      Result<dataset::RecordedFrame> frame = Grey::read(index);
      frame->color_bytes.resize(index == 3 ? 20 : frame->color_bytes.size());
      return frame;
    }
  };
  const auto flickering = *with_flicker(std::make_unique<Damaged>(), "");
  EXPECT_TRUE(flickering->read(2).ok());
  EXPECT_THAT(flickering->read(3).error().message, HasSubstr("colour image"));
}

}  // namespace
}  // namespace hermite::disturb::color_disturbance_test
