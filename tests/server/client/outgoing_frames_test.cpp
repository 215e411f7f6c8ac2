#include "server/client/outgoing_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "proto/wire/client_message.h"
#include "tests/support/few_frames.h"

namespace hermite::client::outgoing_frames_test {
namespace {

using Clock = std::chrono::steady_clock;
using test::FewFrames;
using testing::ElementsAre;
using testing::HasSubstr;

wire::Welcome welcome(std::uint32_t frame_credit, const std::string& resume_token = "a token") {
  wire::Welcome welcome;
  welcome.frame_credit = frame_credit;
  welcome.max_message_bytes = 1000;
  welcome.resume_token = resume_token;
  return welcome;
}

// The number that the server reads from a message.
std::uint64_t sequence_in(const std::string& message) {
  const auto parsed = wire::parse_client_message(message, 1000);
  const auto* frame = parsed.ok() ? std::get_if<wire::Frame>(&*parsed) : nullptr;
  EXPECT_TRUE(frame);
  return frame ? frame->sequence : 0;
}

// Of 5 frames of a recording.
class OutgoingFramesTest : public testing::Test {
 protected:
  // Sends what the credit allows, and returns the numbers of it.
  std::vector<std::uint64_t> send_all() {
    std::vector<std::uint64_t> numbers;
    const auto deadline = Clock::now() + std::chrono::seconds(60);
    while (frames_.has_credit() && (frames_.next() || !frames_.exhausted()) &&
           Clock::now() < deadline) {
      frames_.offer(Clock::now(), false);
      EXPECT_TRUE(frames_.number_next(Clock::now()).ok());
      if (!frames_.next()) {
        std::this_thread::yield();
        continue;
      }
      numbers.push_back(sequence_in(*frames_.next()));
      frames_.sent();
    }
    return numbers;
  }

  // Returns whether the encoder comes to the end of the recording, which its own thread notices.
  bool comes_to_its_end() {
    const auto deadline = Clock::now() + std::chrono::seconds(60);
    while (!frames_.exhausted() && Clock::now() < deadline) {
      frames_.offer(Clock::now(), false);
      std::this_thread::yield();
    }
    return frames_.exhausted();
  }

  const StreamObserver observer_ = {};
  StreamReport report_{observer_, {}};
  FewFrames source_{5};
  OutgoingFrames frames_{source_, {}, report_};
};

TEST_F(OutgoingFramesTest, GoAsFarAsTheCreditReachesAndThenOn) {
  frames_.offer(Clock::now(), false);
  EXPECT_FALSE(frames_.has_waiting()) << "the server has not agreed yet";
  frames_.start(welcome(2), [] {});
  EXPECT_THAT(send_all(), ElementsAre(0, 1));
  frames_.granted({5, 1});
  EXPECT_EQ(frames_.first_kept(), 1u);
  EXPECT_THAT(send_all(), ElementsAre(2, 3, 4));
  EXPECT_TRUE(comes_to_its_end());
  EXPECT_EQ(report_.progress.sent_frames, 5u);
  EXPECT_EQ(report_.progress.durable_frames, 1u);
  EXPECT_EQ(report_.progress.problem_frames, 5u) << "each is sent nevertheless";
}

TEST_F(OutgoingFramesTest, GoAgainWhereTheServerContinues) {
  frames_.start(welcome(4), [] {});
  EXPECT_EQ(send_all().size(), 4u);
  frames_.granted({4, 1});
  EXPECT_TRUE(frames_.resume({2, 4, 2}).ok());
  EXPECT_EQ(frames_.sent_count(), 2u);
  EXPECT_THAT(send_all(), ElementsAre(2, 3)) << "those that were lost on the way";
  EXPECT_EQ(report_.progress.sent_frames, 4u);
  EXPECT_FALSE(frames_.resume({1, 4, 1}).ok()) << "frame 1 is not kept any more";
}

TEST_F(OutgoingFramesTest, AreNotKeptForAServerThatNeverResumes) {
  frames_.start(welcome(3, ""), [] {});
  EXPECT_EQ(send_all().size(), 3u);
  EXPECT_EQ(frames_.first_kept(), 3u);
}

TEST_F(OutgoingFramesTest, WaitInTheSourceWhileTheyAreHeld) {
  frames_.start(welcome(5), [] {});
  for (int i = 0; i < 10; ++i) {
    frames_.offer(Clock::now(), true);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_FALSE(frames_.has_waiting());
  EXPECT_FALSE(frames_.exhausted());
  EXPECT_EQ(send_all().size(), 5u);
}

TEST(OutgoingFrames, OneThatIsTooLongForTheServerIsAnError) {
  const StreamObserver observer;
  StreamReport report{observer, {}};
  FewFrames source(1, 2000);
  OutgoingFrames frames(source, {}, report);
  frames.start(welcome(1), [] {});
  while (!frames.has_waiting()) frames.offer(Clock::now(), false);
  const Status numbered = frames.number_next(Clock::now());
  ASSERT_FALSE(numbered.ok());
  EXPECT_EQ(numbered.error().code, ErrorCode::kTooLarge);
  EXPECT_THAT(numbered.error().message, HasSubstr("the server accepts 1000"));
}

}  // namespace
}  // namespace hermite::client::outgoing_frames_test
