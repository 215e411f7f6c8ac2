#include "core/export/keyframes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/dataset/recording.h"
#include "core/source/open_sequence.h"

namespace hermite::exports {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Frames along x, 2.1 cm apart: five make a spacing.
std::vector<SeenFrame> walk(std::size_t count) {
  std::vector<SeenFrame> frames(count);
  for (std::size_t i = 0; i < count; ++i) {
    frames[i].index = static_cast<std::int64_t>(i);
    frames[i].world_from_camera.translation.x() = 0.021 * static_cast<double>(i);
    frames[i].sharpness = 1;
  }
  return frames;
}

std::vector<std::int64_t> indices(const std::vector<SeenFrame>& frames) {
  std::vector<std::int64_t> result;
  for (const SeenFrame& frame : frames) result.push_back(frame.index);
  return result;
}

TEST(Sharpness, IsOfEdgesAndLessWhenBlurred) {
  ColorImage stripes(32, 32), blurred(32, 32);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const auto value = [](int column) { return column / 4 % 2 ? 200 : 50; };
      const auto soft =
          static_cast<std::uint8_t>((value(x + 1) + 2 * value(x + 2) + value(x + 3)) / 4);
      const auto hard = static_cast<std::uint8_t>(value(x));
      stripes.at(x, y) = {hard, hard, hard};
      blurred.at(x, y) = {soft, soft, soft};
    }
  EXPECT_GT(sharpness(stripes), 2 * sharpness(blurred));
  EXPECT_GT(sharpness(blurred), 0);
  EXPECT_EQ(sharpness(ColorImage(32, 32)), 0);
  EXPECT_EQ(sharpness(ColorImage(2, 2)), 0);
}

TEST(Keyframes, AreTenCentimetresApart) {
  KeyframeOptions options;
  options.window_frames = 1;
  EXPECT_THAT(indices(choose_keyframes(walk(13), options)), ElementsAre(0, 5, 10));
}

TEST(Keyframes, TurningOnTheSpotCountsToo) {
  std::vector<SeenFrame> frames = walk(10);
  for (SeenFrame& frame : frames) {
    frame.world_from_camera.translation.setZero();
    frame.world_from_camera.rotation = Eigen::AngleAxisd(
        static_cast<double>(frame.index) * 4 * M_PI / 180, Eigen::Vector3d::UnitY());
  }
  KeyframeOptions options;
  options.window_frames = 1;
  EXPECT_THAT(indices(choose_keyframes(frames, options)), ElementsAre(0, 3, 6, 9));
}

TEST(Keyframes, TheSharpestOfTheWindowIsTaken) {
  std::vector<SeenFrame> frames = walk(13);
  frames[2].sharpness = 5;
  frames[6].sharpness = 9;  // in the first window too, were it longer
  EXPECT_THAT(indices(choose_keyframes(frames, {.window_frames = 4})), ElementsAre(2, 7, 12));
}

TEST(Keyframes, WhereTheCameraComesBackThereIsNoSecondOne) {
  std::vector<SeenFrame> frames = walk(6), back = walk(6);
  std::reverse(back.begin(), back.end());
  frames.insert(frames.end(), back.begin(), back.end());
  EXPECT_EQ(choose_keyframes(frames, {.window_frames = 1}).size(), 2u);
}

TEST(Keyframes, OfTooManyTheSpacingGrows) {
  const std::vector<SeenFrame> chosen =
      choose_keyframes(walk(500), {.window_frames = 1, .most = 20});
  EXPECT_LE(chosen.size(), 20u);
  EXPECT_GE(chosen.size(), 15u);
  EXPECT_GT(chosen.back().index, 470) << "the end is left out";
  EXPECT_EQ(choose_keyframes(walk(500), {.most = 1}).size(), 1u);
  EXPECT_THAT(choose_keyframes({}, {}), IsEmpty());
}

TEST(Keyframes, LostFramesAndThoseWithoutAPoseAreLeftOut) {
  const std::unique_ptr<dataset::Sequence> sequence =
      or_throw(source::open_sequence("synthetic:frames=6,width=64,height=64"));
  dataset::Trajectory trajectory;
  for (const std::int64_t i : {0, 1, 2, 4}) {
    trajectory.push_back({sequence->timestamp_s(i) + 4e-7, {}});
    // Frame 2 repeats frame 1: lost.
    trajectory.back().world_from_camera.translation.x() = i == 2 ? 1 : static_cast<double>(i);
  }
  const Result<std::vector<SeenFrame>> frames = frames_with_poses(*sequence, trajectory);
  ASSERT_TRUE(frames.ok()) << frames.error().message;
  EXPECT_THAT(indices(*frames), ElementsAre(0, 1, 4));
  EXPECT_EQ((*frames)[2].world_from_camera.translation.x(), 4);
  for (dataset::TimedPose& pose : trajectory) pose.timestamp_s += 1000;
  EXPECT_THAT(frames_with_poses(*sequence, trajectory).error().message,
              HasSubstr("none of the 6 frames"));
  EXPECT_EQ(frames_with_poses(*sequence, {}).error().code, ErrorCode::kNotFound);
}

TEST(Keyframes, TheWorkCanBeEnded) {
  const std::unique_ptr<dataset::Sequence> sequence =
      or_throw(source::open_sequence("synthetic:frames=6,width=64,height=64"));
  const auto stop = [](std::int64_t done, std::int64_t) { return done < 2; };
  EXPECT_EQ(find_keyframes(*sequence, walk(6), {}, stop).error().code, ErrorCode::kBusy);
  const Result<std::vector<SeenFrame>> all =
      find_keyframes(*sequence, walk(6), {}, [](std::int64_t, std::int64_t) { return true; });
  ASSERT_TRUE(all.ok()) << all.error().message;
  EXPECT_GT(all->front().sharpness, 1);
}

}  // namespace
}  // namespace hermite::exports
