#include "server/client/server_answers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "proto/wire/server_message.h"
#include "tests/support/few_frames.h"

namespace hermite::client::server_answers_test {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;

class ServerAnswersTest : public testing::Test {
 protected:
  ServerAnswersTest() {
    observer_.on_link = [this](const std::string& message) { told_.push_back(message); };
  }
  void say(wire::ServerMessage message, milliseconds at = milliseconds(0)) {
    EXPECT_TRUE(answers_.take(wire::format_server_message(std::move(message)), start_ + at).ok());
  }
  static wire::Welcome welcome(const std::string& scan_id) {
    wire::Welcome welcome;
    welcome.server = "a test";
    welcome.scan_id = scan_id;
    welcome.max_message_bytes = 1000;
    welcome.frame_credit = 16;
    welcome.color_codecs = {wire::ColorCodec::kJpeg};
    welcome.camera = {96, 64, 90, 90, 47.5, 31.5, 1000};
    return welcome;
  }
  static wire::FrameResult result(std::uint64_t sequence) {
    wire::FrameResult result;
    result.sequence = sequence;
    return result;
  }

  const SteadyTime start_ = std::chrono::steady_clock::now();
  std::vector<std::string> told_;
  StreamObserver observer_;
  StreamReport report_{observer_, {}};
  const ServerUrl server_;
  Link link_{server_};
  test::FewFrames source_{0};
  OutgoingFrames frames_{source_, {}, report_};
  ServerAnswers answers_{{frames_, link_, report_}};
};

TEST_F(ServerAnswersTest, TheFirstWelcomeCounts) {
  EXPECT_FALSE(answers_.welcome());
  say(welcome("first"));
  say(welcome("second"), milliseconds(10));
  ASSERT_TRUE(answers_.welcome());
  EXPECT_EQ(answers_.welcome()->scan_id, "first");
  EXPECT_EQ(answers_.welcomed_at(), start_);
  EXPECT_FALSE(answers_.is_resumable()) << "it has no token for that";
  EXPECT_EQ(report_.progress.scan_id, "first");
}

TEST_F(ServerAnswersTest, ResultsThatAreSentAgainAreNotCountedAgain) {
  say(result(0));
  say(result(1));
  say(result(0));
  EXPECT_EQ(report_.progress.processed_frames, 2u);
  say(result(2));
  EXPECT_EQ(report_.progress.processed_frames, 3u);
}

TEST_F(ServerAnswersTest, APlaceInTheQueueIsToldWhenItChangesAndForgottenWithTheConnection) {
  say(wire::Waiting{2, 0});
  say(wire::Waiting{2, 0}, milliseconds(10));
  say(wire::Waiting{1, 30}, milliseconds(20));
  EXPECT_THAT(told_,
              ElementsAre("no place on the server yet, waiting behind 2 others",
                          "no place on the server yet, waiting behind 1 others, about 30 s"));
  EXPECT_TRUE(answers_.waiting());
  EXPECT_EQ(answers_.waiting_said_at(), start_ + milliseconds(20));
  answers_.connected(start_ + milliseconds(30));
  EXPECT_FALSE(answers_.waiting());
  EXPECT_EQ(answers_.last_news(), start_ + milliseconds(30));
}

TEST_F(ServerAnswersTest, AServerThatStopsIsLeftAloneForATimeThatItSaysWithinReason) {
  EXPECT_EQ(answers_.take_stay_away().count(), 0);
  say(wire::GoAway{1000});
  EXPECT_TRUE(answers_.is_stopping());
  EXPECT_EQ(answers_.take_stay_away().count(), 1000);
  EXPECT_FALSE(answers_.is_stopping());
  say(wire::GoAway{100'000'000});
  EXPECT_EQ(answers_.take_stay_away().count(), 60'000);
}

TEST_F(ServerAnswersTest, AnErrorEndsTheScanUnlessItIsAboutAFrame) {
  say(wire::ErrorMessage{"busy", "no measurement", true, 7});
  EXPECT_FALSE(answers_.failure());
  EXPECT_EQ(report_.progress.problem_frames, 1u);
  say(wire::ErrorMessage{name_of(ErrorCode::kBusy), "no place", false, 0});
  ASSERT_TRUE(answers_.failure());
  EXPECT_EQ(answers_.failure()->code, ErrorCode::kBusy);
  EXPECT_THAT(answers_.failure()->message, HasSubstr("no place"));
}

TEST_F(ServerAnswersTest, WhoWatchesMayHoldTheFrames) {
  say(wire::PauseRequest{true});
  say(wire::PauseRequest{true});
  EXPECT_TRUE(answers_.holds_frames());
  say(wire::PauseRequest{false});
  EXPECT_FALSE(answers_.holds_frames());
  EXPECT_THAT(told_, ElementsAre(kPausedByViewer, kUnpausedByViewer));
}

TEST_F(ServerAnswersTest, APongIsNoNews) {
  say(result(0));
  say(wire::Pong{1}, milliseconds(10));
  EXPECT_EQ(answers_.last_news(), start_);
}

TEST_F(ServerAnswersTest, WhatIsForViewersIsOnlyCounted) {
  say(wire::SnapshotEnd{});
  EXPECT_EQ(report_.progress.unknown_messages, 1u);
  EXPECT_FALSE(answers_.take("no message", start_).ok());
}

}  // namespace
}  // namespace hermite::client::server_answers_test
