#include "core/calibrate/retimed_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

namespace hermite {
namespace {

// Twice a hand's usual speed.
const std::string kWalked = "synthetic:speed=2,width=320,height=240,frames=7";
constexpr std::int64_t kFrame = 3;
constexpr int kBorder_px = 12;  // what the disturbed frame does not show

std::unique_ptr<Sequence> walked(const std::string& source) { return *open_sequence(source); }

RgbdFrame frame_of(const Sequence& sequence, std::int64_t index = kFrame) { return *decode_frame(*sequence.read(index)); }

template <class Image, class Difference>
std::vector<int> differences(const Image& a, const Image& b, const Difference& difference) {
  std::vector<int> all;
  for (int y = kBorder_px; y < a.height - kBorder_px; ++y)
    for (int x = kBorder_px; x < a.width - kBorder_px; ++x) all.push_back(std::abs(difference(a.at(x, y), b.at(x, y))));
  std::ranges::sort(all);
  return all;
}

// The value that 19 of 20 pixels do not exceed: the rest are edges, of which the disturbance itself has blurred some.
template <class Image, class Difference>
int usual_difference(const Image& a, const Image& b, const Difference& difference) {
  const std::vector<int> all = differences(a, b, difference);
  return all[all.size() * 19 / 20];
}
const auto kOfDepth = [](std::uint16_t a, std::uint16_t b) { return int{a} - int{b}; };
const auto kOfColor = [](const Rgb8& a, const Rgb8& b) { return int{a.g} - int{b.g}; };

std::unique_ptr<Sequence> retimed(const std::string& source, const ImageTiming& timing) {
  std::unique_ptr<Sequence> disturbed = walked(source);
  Trajectory trajectory = disturbed->groundtruth();
  return std::make_unique<RetimedSequence>(std::move(disturbed), timing, std::move(trajectory));
}

TEST(RetimedSequence, UndoesARollingShutter) {
  const std::string rolling = kWalked + "+rolling=ms=30";
  const RgbdFrame truth = frame_of(*walked(kWalked)), disturbed = frame_of(*walked(rolling));
  const RgbdFrame corrected = frame_of(*retimed(rolling, {0.030, 0.030, 0}));
  EXPECT_LT(4 * usual_difference(corrected.depth, truth.depth, kOfDepth), usual_difference(disturbed.depth, truth.depth, kOfDepth));
  EXPECT_LT(2 * usual_difference(corrected.color, truth.color, kOfColor), usual_difference(disturbed.color, truth.color, kOfColor));
}

TEST(RetimedSequence, UndoesTheDelayOfColourAndLeavesDepthAsItIs) {
  const std::string late = kWalked + "+clock=ms=16";
  const RgbdFrame truth = frame_of(*walked(kWalked)), disturbed = frame_of(*walked(late));
  const RgbdFrame corrected = frame_of(*retimed(late, {0, 0, 0.016}));
  EXPECT_EQ(corrected.depth, truth.depth);
  EXPECT_LT(3 * usual_difference(corrected.color, truth.color, kOfColor), usual_difference(disturbed.color, truth.color, kOfColor));
}

TEST(RetimedSequence, AFrameWithoutAVelocityStaysAsItIs) {
  const std::string rolling = kWalked + "+rolling=ms=30";
  const RgbdFrame disturbed = frame_of(*walked(rolling));
  const RetimedSequence untimed(walked(rolling), {0.030, 0.030, 0.010}, {});
  EXPECT_EQ(frame_of(untimed).depth, disturbed.depth);
  EXPECT_EQ(untimed.timestamp_s(kFrame), walked(kWalked)->timestamp_s(kFrame));
}

TEST(RetimedSequence, FramesAreRectified) {
  std::unique_ptr<Sequence> plain = walked(kWalked);
  Camera camera = plain->camera();
  camera.distortion.k1 = 0.05;
  camera.depth_correction.bend = 0.01;
  Trajectory trajectory = plain->groundtruth();
  const RetimedSequence sequence(std::make_unique<RecalibratedSequence>(std::move(plain), camera), {0.010, 0, 0}, std::move(trajectory));
  EXPECT_EQ(sequence.camera(), rectified(camera));
  EXPECT_EQ(frame_of(sequence).depth.width, camera.width);
}

class WithOneBroken : public ChangedSequence {
 public:
  using ChangedSequence::ChangedSequence;
  Result<RecordedFrame> read(std::int64_t index) const override {
    Result<RecordedFrame> frame = ChangedSequence::read(index);
    if (index == 2) frame->color_bytes.resize(10);
    return frame;
  }
};

TEST(RetimedSequence, AFrameThatCannotBeReadIsAnErrorOfThatFrame) {
  std::unique_ptr<Sequence> broken = std::make_unique<WithOneBroken>(walked(kWalked));
  Trajectory trajectory = broken->groundtruth();
  const RetimedSequence sequence(std::move(broken), {0.030, 0.030, 0}, std::move(trajectory));
  EXPECT_FALSE(sequence.read(2).ok());
  EXPECT_TRUE(sequence.read(3).ok());
}

}  // namespace
}  // namespace hermite
