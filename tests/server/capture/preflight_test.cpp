#include "server/capture/preflight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/source/open_sequence.h"

namespace hermite::client::preflight_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kFrames = 6;

// What a camera may give otherwise than a good one.
struct Fault {
  double depth_factor = 1;  // 0: none
  double grey_factor = 1;
  std::uint8_t grey_added = 0;
  int shift_px = 0;  // of colour against depth
  double time_factor = 1;
  double host_time_factor = 1;
  int missing_frame = -1;
  std::uint64_t unpaired = 0;
};

std::uint8_t shade(double grey, const Fault& fault) {
  return static_cast<std::uint8_t>(std::min(255.0, grey * fault.grey_factor + fault.grey_added));
}

frame::RgbdFrame changed(frame::RgbdFrame frame, const Fault& fault) {
  for (std::uint16_t& depth : frame.depth.pixels)
    depth = static_cast<std::uint16_t>(depth * fault.depth_factor);
  ColorImage color = frame.color;
  for (int y = 0; y < color.height; ++y)
    for (int x = 0; x < color.width; ++x) {
      const Rgb8 from = frame.color.at(std::clamp(x - fault.shift_px, 0, color.width - 1), y);
      color.at(x, y) = {shade(from.r, fault), shade(from.g, fault), shade(from.b, fault)};
    }
  frame.color = std::move(color);
  return frame;
}

std::vector<std::string> doubts_of(const Fault& fault) {
  static const std::unique_ptr<dataset::Sequence> room =
      *source::open_sequence("synthetic:frames=6,width=320,height=240");
  Preflight preflight({"a camera", room->camera(), "its own", 30});
  for (int i = 0; i < kFrames; ++i) {
    frame::RgbdFrame frame = changed(*dataset::decode_frame(*room->read(i)), fault);
    frame.timestamp_s *= fault.time_factor;
    if (i != fault.missing_frame)
      preflight.add(frame, 100 + i / 30.0 * fault.time_factor * fault.host_time_factor,
                    {.unpaired = fault.unpaired});
  }
  return preflight.doubts();
}

TEST(Preflight, FindsNothingWrongWithAGoodCamera) { EXPECT_THAT(doubts_of({}), IsEmpty()); }

TEST(Preflight, SaysWhatIsWrongWithDepth) {
  EXPECT_THAT(doubts_of({.depth_factor = 0}), ElementsAre(HasSubstr("no pixel has depth")));
  EXPECT_THAT(doubts_of({.depth_factor = 0.18}), testing::Contains(HasSubstr("too near")));
  EXPECT_THAT(doubts_of({.depth_factor = 0.02}), testing::Contains(HasSubstr("depth unit")));
}

TEST(Preflight, SaysWhatIsWrongWithTheImage) {
  EXPECT_THAT(doubts_of({.grey_factor = 0.1}), ElementsAre(HasSubstr("the image is dark")));
  EXPECT_THAT(doubts_of({.grey_factor = 0.1, .grey_added = 230}),
              ElementsAre(HasSubstr("overexposed")));
  EXPECT_THAT(doubts_of({.shift_px = 12}), ElementsAre(HasSubstr("registered")));
}

TEST(Preflight, SaysWhatIsWrongWithTheTimes) {
  EXPECT_THAT(doubts_of({.time_factor = 2}), ElementsAre(HasSubstr("15 frames a second")));
  EXPECT_THAT(doubts_of({.missing_frame = 2}),
              ElementsAre(HasSubstr("frames are missing at 1 place")));
  EXPECT_THAT(doubts_of({.host_time_factor = 5}), ElementsAre(HasSubstr("do not fit the clock")));
  EXPECT_THAT(doubts_of({.unpaired = 4}), ElementsAre(HasSubstr("4 depth images had no colour")));
}

TEST(Preflight, SumsUpInALine) {
  const auto room = *source::open_sequence("synthetic:frames=2,width=160,height=120");
  Preflight preflight({"a camera", room->camera(), "its own", 30});
  for (int i = 0; i < 2; ++i) preflight.add(*dataset::decode_frame(*room->read(i)), i / 30.0);
  EXPECT_THAT(preflight.summary(),
              testing::StartsWith("2 frames at 30 Hz, 100 % of the pixels have depth, "));
}

TEST(PreflightDeathTest, WithoutAFrameThereIsNothingToSay) {
  EXPECT_DEATH(static_cast<void>(Preflight({"a camera", Camera{}, "", 30}).doubts()),
               "nothing was looked at");
}

}  // namespace
}  // namespace hermite::client::preflight_test
