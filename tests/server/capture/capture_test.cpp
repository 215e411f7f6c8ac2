#include "server/capture/capture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/capture/scripted_camera.h"

namespace hermite::client::capture_test {
namespace {

using testing::HasSubstr;

const Camera kCamera{64, 64, 60, 60, 31.5, 31.5, 1000};

// Runs a capture until it has ended, or a minute.
struct Captured {
  explicit Captured(test::ScriptedCamera& camera, Capture::Settings settings = {})
      : capture(camera, settings, events()) {}
  Capture::Events events() {
    return {.on_frame =
                [this](frame::RgbdFrame frame) {
                  times_s.push_back(frame.timestamp_s);
                  return true;
                },
            .on_end = [this] { ++end_count; },
            .wishes =
                [this] {
                  return CaptureWishes{paused, interrupts};
                }};
  }
  CaptureState wait() {
    for (int i = 0; i < 60'000 && !capture.state().ended; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return capture.state();
  }

  std::atomic<bool> paused{false};
  std::atomic<int> interrupts{0}, end_count{0};
  std::vector<double> times_s;  // read after the end
  Capture capture;
};

TEST(Capture, HandsOnEveryFrameAndEndsAfterEnough) {
  test::ScriptedCamera camera(kCamera);
  camera.add_frames(50);
  Captured run(camera, {.max_frames = 45});
  const CaptureState state = run.wait();
  EXPECT_TRUE(state.ended);
  EXPECT_FALSE(state.failure);
  EXPECT_EQ(state.frame_count, 45u);
  EXPECT_EQ(run.times_s.size(), 45u);
  EXPECT_NEAR(state.newest_s, 44 / 30.0, 1e-9);
  EXPECT_NEAR(state.rate_hz, 30, 0.1);
  EXPECT_EQ(state.coverage, 1);
  EXPECT_EQ(run.end_count, 1);
}

TEST(Capture, AnInterruptEndsItAndTheSecondIsSeenAfterwards) {
  test::ScriptedCamera camera(kCamera);
  Captured run(camera);
  run.interrupts = 1;
  EXPECT_TRUE(run.wait().ended);
  run.interrupts = 2;
  for (int i = 0; i < 60'000 && run.capture.interrupt_count() < 2; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(run.capture.interrupt_count(), 2);
  EXPECT_EQ(run.end_count, 1);
}

TEST(Capture, FramesOfAPauseAreThrownAway) {
  test::ScriptedCamera camera(kCamera);
  camera.add_frames(5);
  camera.script.emplace_back(Error{ErrorCode::kNotFound, "the end"});
  Captured run(camera);
  run.paused = true;  // maybe not before the first frame
  const CaptureState state = run.wait();
  EXPECT_EQ(state.frame_count, run.times_s.size());
  EXPECT_FALSE(state.failure) << "the end of a recording is no failure";
}

TEST(Capture, FramesBeforeAnybodyListensDoNotCount) {
  test::ScriptedCamera camera(kCamera);
  camera.add_frames(5);
  camera.script.emplace_back(Error{ErrorCode::kNotFound, "the end"});
  std::atomic<int> offered{0};
  Capture capture(camera, {},
                  {.on_frame = [&](frame::RgbdFrame) { return ++offered > 3; },
                   .on_end = [] {},
                   .wishes = [] { return CaptureWishes{}; }});
  for (int i = 0; i < 60'000 && !capture.state().ended; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(capture.state().frame_count, 2u);
  EXPECT_NEAR(capture.state().first_s, 3 / 30.0, 1e-9);
}

TEST(Capture, ACameraThatBreaksIsSaidInAMessage) {
  test::ScriptedCamera camera(kCamera);
  camera.add_frames(2);
  camera.script.emplace_back(Error{ErrorCode::kDevice, "the cable is out"});
  Captured run(camera);
  const CaptureState state = run.wait();
  ASSERT_TRUE(state.failure);
  EXPECT_EQ(state.failure->message, "the cable is out");
  EXPECT_EQ(state.frame_count, 2u);
}

TEST(Capture, ASilentCameraIsTakenToBeGone) {
  test::ScriptedCamera camera(kCamera);
  camera.add_frames(1);
  Captured run(camera, {.silence = std::chrono::milliseconds(150)});
  const CaptureState state = run.wait();
  ASSERT_TRUE(state.failure);
  EXPECT_THAT(state.failure->message, HasSubstr("silent"));
}

TEST(Capture, GoesInTheMiddle) {
  test::ScriptedCamera camera(kCamera);
  int ends = 0;
  {
    Capture capture(camera, {},
                    {.on_frame = [](frame::RgbdFrame) { return true; },
                     .on_end = [&] { ++ends; },
                     .wishes = [] { return CaptureWishes{}; }});
  }
  EXPECT_EQ(ends, 1);
}

}  // namespace
}  // namespace hermite::client::capture_test
