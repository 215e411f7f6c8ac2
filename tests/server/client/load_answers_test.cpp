#include "server/client/load_answers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::client::load_answers_test {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

const SteadyTime kStart{};

StreamProgress progress(std::uint64_t sent,
                        std::optional<std::uint64_t> last_result = std::nullopt) {
  StreamProgress progress;
  progress.sent_frames = sent;
  if (last_result) {
    progress.last_result.emplace();
    progress.last_result->sequence = *last_result;
  }
  return progress;
}

TEST(AnswerTimes, CountFromTheReportBeforeTheFrameWasSentToItsResult) {
  AnswerTimes answers;
  answers.see(progress(0), kStart);
  answers.see(progress(1), kStart + milliseconds(4));  // sent after the first report
  answers.see(progress(2), kStart + milliseconds(10));
  answers.see(progress(2, 0), kStart + milliseconds(30));
  answers.see(progress(2, 0), kStart + milliseconds(40));  // nothing new
  answers.see(progress(2, 1), kStart + milliseconds(54));
  EXPECT_THAT(answers.times_ms(), ElementsAre(30, 50));
}

TEST(AnswerTimes, HaveNoneOfAFrameThatTheServerDrops) {
  AnswerTimes answers;
  answers.see(progress(0), kStart);
  answers.see(progress(3), kStart);
  answers.see(progress(3, 2), kStart + milliseconds(7));
  EXPECT_THAT(answers.times_ms(), ElementsAre(7));
}

TEST(AnswerTimes, IgnoreResultsThatAreRepeatedAndFramesThatAreSentAgain) {
  AnswerTimes answers;
  answers.see(progress(0), kStart);
  answers.see(progress(2, 0), kStart + milliseconds(5));
  answers.see(progress(2, 0), kStart + milliseconds(500));
  answers.see(progress(2, 1), kStart + milliseconds(900));
  EXPECT_THAT(answers.times_ms(), ElementsAre(5, 900));
}

TEST(AnswerTimes, KeepNoMoreThanSomeThousandUnansweredFrames) {
  AnswerTimes answers;
  answers.see(progress(0), kStart);
  answers.see(progress(1'000'000), kStart);
  answers.see(progress(1'000'000, 10), kStart + milliseconds(5));
  EXPECT_THAT(answers.times_ms(), IsEmpty());
  answers.see(progress(1'000'000, 999'999), kStart + milliseconds(6));
  EXPECT_THAT(answers.times_ms(), ElementsAre(6));
}

StreamProgress offered(std::uint64_t sent, std::uint64_t dropped, std::uint64_t left_out) {
  StreamProgress progress;
  progress.frame_count = 50;
  progress.sent_frames = sent;
  progress.dropped_frames = dropped;
  progress.left_out_frames = left_out;
  return progress;
}

TEST(OfferedFrames, AreComparedWithTheClockSinceTheFirst) {
  OfferedFrames frames(10);
  frames.see(offered(0, 0, 0), kStart);
  EXPECT_EQ(frames.due(), 0u);
  frames.see(offered(1, 0, 0), kStart + milliseconds(5000));
  EXPECT_EQ(frames.due(), 1u);
  frames.see(offered(2, 1, 1), kStart + milliseconds(5950));
  EXPECT_EQ(frames.offered(), 4u);
  EXPECT_EQ(frames.due(), 10u);
}

TEST(OfferedFrames, AreDueUntilTheSequenceOrTheSendingEnds) {
  OfferedFrames frames(10);
  frames.see(offered(1, 0, 0), kStart);
  frames.see(offered(3, 0, 0), kStart + milliseconds(60'000));
  EXPECT_EQ(frames.due(), 50u);
  OfferedFrames finished(10);
  finished.see(offered(1, 0, 0), kStart);
  StreamProgress finishing = offered(3, 0, 0);
  finishing.finishing = true;
  finished.see(finishing, kStart + milliseconds(60'000));
  EXPECT_EQ(finished.due(), 3u);
}

}  // namespace
}  // namespace hermite::client::load_answers_test
