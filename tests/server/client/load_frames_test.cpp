#include "server/client/load_frames.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "core/source/open_sequence.h"
#include "server/client/frame_encoder.h"

namespace hermite::client::load_frames_test {
namespace {

constexpr std::size_t kPlenty = std::size_t{1} << 30;
constexpr int kFrameCount = 5;

std::unique_ptr<dataset::Sequence> room() {
  return *source::open_sequence("synthetic:frames=" + std::to_string(kFrameCount) +
                                ",width=160,height=120");
}

void expect_frame(const EncodedFrame& frame, const dataset::Sequence& sequence, std::int64_t index,
                  const WireEncoding& encoding) {
  const EncodedFrame expected = encode_frame(sequence, index, encoding);
  EXPECT_EQ(frame.index, index);
  EXPECT_EQ(frame.frame.timestamp_s, expected.frame.timestamp_s);
  EXPECT_EQ(frame.frame.depth, expected.frame.depth);
  EXPECT_EQ(frame.frame.color, expected.frame.color);
}

TEST(LoadFrames, AreThoseOfTheSequenceAndEncodedOnce) {
  const auto sequence = room();
  LoadFrames frames(*sequence, kPlenty);
  for (int time = 0; time < 2; ++time) {
    LoadCameraFrames camera(frames);
    EXPECT_EQ(camera.expected_frames(), kFrameCount);
    EXPECT_FALSE(camera.depth_codecs().empty());
    EncodedFrame frame;
    for (int i = 0; i < kFrameCount; ++i) {
      ASSERT_EQ(camera.next({}, frame), Supply::kFrame);
      expect_frame(frame, *sequence, i, {});
    }
    EXPECT_EQ(camera.next({}, frame), Supply::kEnd);
    EXPECT_EQ(frames.kept_count(), kFrameCount);
  }
}

TEST(LoadFrames, AreKeptForEachEncoding) {
  const auto sequence = room();
  LoadFrames frames(*sequence, kPlenty);
  const WireEncoding small{.depth = wire::DepthCodec::kPng16, .jpeg_quality = 70};
  expect_frame(frames.frame(1, {}), *sequence, 1, {});
  expect_frame(frames.frame(1, small), *sequence, 1, small);
  EXPECT_EQ(frames.kept_count(), 2u);
}

TEST(LoadFrames, ThatDoNotFitAreEncodedEveryTime) {
  const auto sequence = room();
  LoadFrames frames(*sequence, 1);
  for (int i = 0; i < kFrameCount; ++i) expect_frame(frames.frame(i, {}), *sequence, i, {});
  EXPECT_EQ(frames.kept_count(), 1u) << "the first found room";
}

TEST(LoadFrames, ArePreparedAsTheCamerasWillAskForThem) {
  const auto sequence = room();
  LoadFrames all(*sequence, kPlenty);
  std::int64_t last = 0;
  all.prepare(kFrameCount + 10, [&](std::int64_t done) {
    EXPECT_EQ(done, ++last);
    return true;
  });
  EXPECT_EQ(last, kFrameCount);
  EXPECT_EQ(all.kept_count(), kFrameCount);
  EncodedFrame first;
  LoadCameraFrames camera(all);
  const wire::DepthCodec codec = camera.depth_codecs().front();
  ASSERT_EQ(camera.next({.depth = codec}, first), Supply::kFrame);
  EXPECT_EQ(all.kept_count(), kFrameCount) << "the cameras use what was prepared";
}

TEST(LoadFrames, AreTheSameForManyCamerasAtOnce) {
  const auto sequence = room();
  LoadFrames frames(*sequence, kPlenty);
  std::vector<EncodedFrame> got(4);
  std::vector<std::thread> cameras;
  for (EncodedFrame& frame : got)
    cameras.emplace_back([&frames, &frame] { frame = frames.frame(2, {}); });
  for (std::thread& camera : cameras) camera.join();
  for (const EncodedFrame& frame : got) expect_frame(frame, *sequence, 2, {});
  EXPECT_EQ(frames.kept_count(), 1u);
}

}  // namespace
}  // namespace hermite::client::load_frames_test
