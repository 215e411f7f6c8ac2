#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/read_ahead.h"
#include "core/pipeline/pipeline.h"
#include "tests/support/recording.h"

namespace hermite::pipeline::prepare_test {
namespace {

// The frames are taken for those of a lens that bends a little: there is something to be
// straightened.
test::Recording bent() {
  test::Recording recording = test::record("synthetic:frames=8,width=160,height=120");
  recording.camera.distortion.k1 = 0.05;
  return recording;
}

bool same_pose(const dataset::TimedPose& a, const dataset::TimedPose& b) {
  return a.timestamp_s == b.timestamp_s &&
         a.world_from_camera.translation == b.world_from_camera.translation &&
         a.world_from_camera.rotation.coeffs() == b.world_from_camera.rotation.coeffs();
}

TEST(Prepare, AheadOnAnotherThreadTheScanIsTheSameBitForBit) {
  const test::Recording room = bent();
  Pipeline at_once("", room.camera, Options{}), ahead("", room.camera, Options{});
  ReadAhead<Result<frame::PreparedFrame>> prepared(
      0, static_cast<std::int64_t>(room.frames.size()), 3, [&](std::int64_t index) {
        return ahead.prepare(room.frames[static_cast<std::size_t>(index)]);
      });
  for (const frame::RgbdFrame& frame : room.frames) {
    const auto next = prepared.next();
    ASSERT_TRUE(next && next->ok());
    EXPECT_NE((*next)->frame.depth, frame.depth) << "it is straight now";
    const Result<FrameResult> result = ahead.process(**next);
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(result->status, track::TrackingStatus::kTracked) << result->reason;
    EXPECT_TRUE(at_once.process(frame).ok());
  }
  EXPECT_TRUE(std::ranges::equal(ahead.trajectory(), at_once.trajectory(), same_pose));
}

TEST(Prepare, AFrameOfAnotherSizeIsRefusedBeforeItsTurnAndAtIt) {
  const test::Recording room = bent();
  Pipeline pipeline("", room.camera, Options{});
  frame::RgbdFrame narrow = room.frames[0];
  narrow.depth = DepthImage(80, 120);
  const Result<frame::PreparedFrame> prepared = pipeline.prepare(narrow);
  ASSERT_FALSE(prepared.ok());
  EXPECT_EQ(prepared.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(prepared.error().message.find("80x120"), std::string::npos) << prepared.error().message;
  frame::PreparedFrame made_elsewhere;
  made_elsewhere.frame = narrow;
  const Result<FrameResult> processed = pipeline.process(made_elsewhere);
  ASSERT_FALSE(processed.ok());
  EXPECT_EQ(processed.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace hermite::pipeline::prepare_test
