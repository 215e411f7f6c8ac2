#include "server/scan/scan_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

namespace hermite::server::scan_camera_test {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr milliseconds kWindow(1000), kPatience(500);

class ScanCameraTest : public testing::Test {
 protected:
  CameraLink link(const std::string& name, bool can_pause = true) {
    return {.send =
                [this, name](const wire::ServerMessage& message) {
                  const auto* request = std::get_if<wire::PauseRequest>(&message);
                  heard_.push_back(name + (!request          ? " hears"
                                           : request->paused ? " is to pause"
                                                             : " is to go on"));
                },
            .ended = [this, name] { heard_.push_back(name + " ends"); },
            .superseded =
                [this, name] {
                  heard_.push_back(name + " is superseded");
                  EXPECT_FALSE(camera_.detach(1)) << "its reaction concerns the new one no more";
                },
            .go_away = [this, name] { heard_.push_back(name + " goes away"); },
            .can_pause = can_pause};
  }
  ScanCamera::Clock::time_point after(milliseconds time) const { return start_ + time; }

  const ScanCamera::Clock::time_point start_ = ScanCamera::Clock::now();
  ScanCamera camera_{kWindow, kPatience};
  std::vector<std::string> heard_;
};

TEST_F(ScanCameraTest, ANewOneSupersedesTheOneBefore) {
  EXPECT_EQ(camera_.attach(link("first")), 1u);
  EXPECT_EQ(camera_.attach(link("second")), 2u);
  camera_.send(wire::Pong{1});
  camera_.say_go_away();
  camera_.say_ended();
  EXPECT_TRUE(camera_.detach(2));
  EXPECT_FALSE(camera_.detach(2));
  camera_.send(wire::Pong{2});
  camera_.say_ended();
  EXPECT_THAT(heard_, ElementsAre("first is superseded", "second hears", "second goes away",
                                  "second ends"));
}

TEST_F(ScanCameraTest, ALostOneIsWaitedForUntilItsTimeIsOver) {
  camera_.attach(link("first"));
  ASSERT_TRUE(camera_.detach(1));
  camera_.wait({ErrorCode::kIo, "the link broke"}, start_);
  EXPECT_TRUE(camera_.is_waited_for());
  EXPECT_EQ(camera_.message(), "waiting for the camera to come back: the link broke");
  EXPECT_FALSE(camera_.given_up(true, after(kWindow - milliseconds(1))));
  camera_.attach(link("second"));
  EXPECT_FALSE(camera_.is_waited_for());
  EXPECT_EQ(camera_.message(), "");
  EXPECT_FALSE(camera_.given_up(true, after(kWindow)));

  ASSERT_TRUE(camera_.detach(2));
  camera_.wait({ErrorCode::kIo, "the link broke again"}, start_);
  const auto why = camera_.given_up(true, after(kWindow));
  ASSERT_TRUE(why);
  EXPECT_EQ(why->message, "the link broke again");
  EXPECT_FALSE(camera_.given_up(true, after(2 * kWindow))) << "once";
}

TEST_F(ScanCameraTest, OneThatSendsNothingAlthoughItMayIsGivenUp) {
  EXPECT_FALSE(camera_.given_up(true, after(100 * kPatience))) << "there is none";
  camera_.attach(link("first"));
  EXPECT_FALSE(camera_.given_up(true, start_));
  EXPECT_FALSE(camera_.given_up(false, after(kPatience))) << "it waits for the server";
  EXPECT_FALSE(camera_.given_up(true, after(kPatience)));
  camera_.frame_came();
  EXPECT_FALSE(camera_.given_up(true, after(2 * kPatience)));
  const auto why = camera_.given_up(true, after(3 * kPatience));
  ASSERT_TRUE(why);
  EXPECT_EQ(why->code, ErrorCode::kBusy);
}

TEST_F(ScanCameraTest, APausedOneIsGivenMoreTimeButNotForEver) {
  camera_.attach(link("first"));
  EXPECT_TRUE(camera_.pause(true));
  EXPECT_FALSE(camera_.pause(true));
  EXPECT_EQ(camera_.message(), "paused by its camera");
  EXPECT_FALSE(camera_.given_up(true, start_));
  EXPECT_FALSE(camera_.given_up(true, after(100 * kPatience)));
  const auto why = camera_.given_up(true, after(kMaxPause));
  ASSERT_TRUE(why);
  EXPECT_THAT(why->message, HasSubstr("in which it was paused"));
}

TEST_F(ScanCameraTest, IsAskedToPauseIfItIsThereAndCan) {
  EXPECT_FALSE(camera_.can_pause());
  EXPECT_THAT(camera_.ask_to_pause(true).error().message, HasSubstr("not connected"));
  camera_.attach(link("first"));
  EXPECT_TRUE(camera_.can_pause());
  EXPECT_TRUE(camera_.ask_to_pause(true).ok());
  EXPECT_FALSE(camera_.is_paused()) << "it has not said so yet";
  EXPECT_TRUE(camera_.ask_to_pause(false).ok());
  EXPECT_THAT(heard_, ElementsAre("first is to pause", "first is to go on"));
  camera_.attach(link("older", false));
  EXPECT_THAT(camera_.ask_to_pause(true).error().message, HasSubstr("cannot be asked"));
}

}  // namespace
}  // namespace hermite::server::scan_camera_test
