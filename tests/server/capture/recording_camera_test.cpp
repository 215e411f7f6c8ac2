#include "server/capture/recording_camera.h"
#include "core/source/open_sequence.h"

#include <gtest/gtest.h>

namespace hermite::client::recording_camera_test {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kPatience(60);

TEST(RecordingCamera, GivesEveryFrameNotBeforeItsTimeAndThenTheEnd) {
  const auto room = *source::open_sequence("synthetic:frames=4,width=96,height=72");
  const auto camera =
      play_recording(*source::open_sequence("synthetic:frames=4,width=96,height=72"));
  EXPECT_EQ(camera->description().camera, room->camera());
  EXPECT_EQ(camera->description().frame_rate_hz, room->frame_rate_hz());
  const auto start = Clock::now();
  for (std::int64_t i = 0; i < 4; ++i) {
    const auto frame = camera->next(kPatience);
    ASSERT_TRUE(frame.ok() && *frame);
    EXPECT_EQ((*frame)->timestamp_s, room->timestamp_s(i));
    EXPECT_EQ((*frame)->depth, room->read(i)->depth);
  }
  EXPECT_GE(std::chrono::duration<double>(Clock::now() - start).count(),
            room->timestamp_s(3) - room->timestamp_s(0) - 0.001);
  const auto end = camera->next(kPatience);
  ASSERT_FALSE(end.ok());
  EXPECT_EQ(end.error().code, ErrorCode::kNotFound);
}

TEST(RecordingCamera, PatienceHasAnEnd) {
  const auto camera =
      play_recording(*source::open_sequence("synthetic:frames=40,width=96,height=72+missing=1:38"));
  ASSERT_TRUE(camera->next(kPatience).ok());
  const auto none = camera->next(std::chrono::milliseconds(5));
  ASSERT_TRUE(none.ok());
  EXPECT_FALSE(*none) << "the next one is due after 1.3 s";
}

TEST(RecordingCamera, AFrameThatCannotBeReadIsLeftOut) {
  const auto camera =
      play_recording(*source::open_sequence("synthetic:frames=3,width=96,height=72+missing=1:1"));
  int count = 0;
  for (auto frame = camera->next(kPatience); frame.ok(); frame = camera->next(kPatience))
    count += *frame ? 1 : 0;
  EXPECT_EQ(count, 2);
}

}  // namespace
}  // namespace hermite::client::recording_camera_test
