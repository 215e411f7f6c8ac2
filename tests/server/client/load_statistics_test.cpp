#include "server/client/load_statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace hermite::client::load_statistics_test {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(TimeSummary, HasTheNearestRanks) {
  std::vector<float> values(200);
  std::iota(values.begin(), values.end(), 1.0F);
  std::reverse(values.begin(), values.end());
  const TimeSummary summary = summary_of(values);
  EXPECT_EQ(summary.count, 200u);
  EXPECT_EQ(summary.median, 100);
  EXPECT_EQ(summary.p95, 190);
  EXPECT_EQ(summary.p99, 198);
  EXPECT_EQ(summary.largest, 200);
}

TEST(TimeSummary, OfFewValuesHasOneOfThem) {
  EXPECT_EQ(summary_of({}).count, 0u);
  EXPECT_EQ(summary_of({}).largest, 0);
  for (const double value :
       {summary_of({7}).median, summary_of({7}).p95, summary_of({7}).p99, summary_of({7}).largest})
    EXPECT_EQ(value, 7);
  EXPECT_EQ(summary_of({9, 3}).median, 3);
  EXPECT_EQ(summary_of({9, 3}).p95, 9);
}

TEST(Messages, AreCountedShortAndPrintable) {
  MessageCounts counts;
  count_message(counts, "no place");
  count_message(counts, "no place");
  count_message(counts, "red \x1b[31m");
  count_message(counts, std::string(1000, 'x'));
  EXPECT_THAT(counts, ElementsAre(Pair("no place", 2), Pair("red ?[31m", 1),
                                  Pair(std::string(300, 'x'), 1)));
}

TEST(Messages, OfManyKindsAreCountedTogether) {
  MessageCounts counts;
  for (std::size_t i = 0; i < 2 * kMaxLoadMessages; ++i)
    count_message(counts, "frame " + std::to_string(i));
  EXPECT_EQ(counts.size(), kMaxLoadMessages + 1);
  EXPECT_EQ(counts["other messages"], kMaxLoadMessages);
  MessageCounts sum = counts;
  add_messages(sum, counts);
  EXPECT_EQ(sum.size(), kMaxLoadMessages + 1);
  EXPECT_EQ(sum["frame 0"], 2u);
  EXPECT_EQ(sum["other messages"], 2 * kMaxLoadMessages);
}

CameraLoad camera() {
  CameraLoad camera;
  camera.scans_begun = camera.scans_finished = 2;
  camera.due = 110;
  camera.offered = 100;
  camera.sent = 90;
  camera.answered = 80;
  camera.tracked = 60;
  camera.client_dropped = 7;
  camera.server_dropped = 10;
  camera.left_out = 3;
  camera.answer_ms = {10, 20};
  camera.refusals = {{"busy", 1}};
  return camera;
}

TEST(CameraLoads, AreSummed) {
  CameraLoad other;
  other.scans_begun = other.scans_failed = other.refused = other.reconnects = 1;
  other.offered = other.sent = 20;
  other.answer_ms = {500};
  other.wait_s = {3};
  other.without_place = true;
  other.refusals = {{"busy", 2}};
  other.other = {{"lost", 1}};
  const CameraLoad sum = sum_of({camera(), other});
  EXPECT_EQ(sum.scans_begun, 3u);
  EXPECT_EQ(sum.scans_finished, 2u);
  EXPECT_EQ(sum.scans_failed, 1u);
  EXPECT_EQ(sum.offered, 120u);
  EXPECT_EQ(sum.due, 110u);
  EXPECT_EQ(sum.sent, 110u);
  EXPECT_EQ(sum.answered, 80u);
  EXPECT_EQ(sum.tracked, 60u);
  EXPECT_EQ(sum.client_dropped + sum.server_dropped + sum.left_out, 20u);
  EXPECT_EQ(sum.reconnects, 1u);
  EXPECT_THAT(sum.answer_ms, ElementsAre(10, 20, 500));
  EXPECT_THAT(sum.wait_s, ElementsAre(3));
  EXPECT_TRUE(sum.without_place);
  EXPECT_THAT(sum.refusals, ElementsAre(Pair("busy", 3)));
  EXPECT_THAT(sum.other, ElementsAre(Pair("lost", 1)));
}

TEST(CameraLoads, HaveShares) {
  EXPECT_DOUBLE_EQ(unanswered_share(camera()), 0.2);
  EXPECT_DOUBLE_EQ(tracked_share(camera()), 0.75);
  EXPECT_EQ(unanswered_share({}), 0);
  EXPECT_EQ(tracked_share({}), 0);
}

TEST(CameraLoads, GetThroughWithOneScanAndWithoutAFailure) {
  LoadResult result;
  EXPECT_FALSE(all_got_through(result)) << "nobody tried";
  result.cameras = {camera()};
  EXPECT_TRUE(all_got_through(result));
  result.cameras.push_back(camera());
  result.cameras.back().scans_failed = 1;
  EXPECT_FALSE(all_got_through(result));
  result.cameras.back() = {};
  EXPECT_FALSE(all_got_through(result)) << "one never began";
}

TEST(ViewerLoads, AreSummed) {
  ViewerLoad one;
  one.watched = 3;
  one.refused = 1;
  one.disconnected = 2;
  one.messages = 10;
  one.received_bytes = 1000;
  one.sent_bytes = 50;
  one.watched_s = 4.5;
  one.snapshot_ms = {30};
  one.problems = {{"busy", 1}};
  one.busiest_thread = 0.5;
  ViewerLoad other = one;
  other.busiest_thread = 0.25;
  const ViewerLoad sum = sum_of({one, other});
  EXPECT_EQ(sum.watched, 6u);
  EXPECT_EQ(sum.refused, 2u);
  EXPECT_EQ(sum.disconnected, 4u);
  EXPECT_EQ(sum.messages, 20u);
  EXPECT_EQ(sum.received_bytes, 2000u);
  EXPECT_EQ(sum.sent_bytes, 100u);
  EXPECT_EQ(sum.watched_s, 9);
  EXPECT_THAT(sum.snapshot_ms, ElementsAre(30, 30));
  EXPECT_THAT(sum.problems, ElementsAre(Pair("busy", 2)));
  EXPECT_EQ(sum.busiest_thread, 0.5) << "the busiest, not the sum";
}

}  // namespace
}  // namespace hermite::client::load_statistics_test
