#include "server/access/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace hermite::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A line whose scans begin as soon as they may, and what those in it were told last.
class Line {
 public:
  explicit Line(PlaceRules rules) : places(rules) {}

  Result<Places::Ticket> wait(const std::string& scan, const PlaceRequest& request) {
    return places.wait(
        request, [this, scan](const wire::Waiting& waiting) { told[scan] = waiting; },
        [this, scan, request] {
          begun.push_back(scan);
          places.began(scan, request);
        });
  }
  void end(const std::string& scan) {
    places.ended(scan);
    places.serve();
  }

  Places places;
  std::vector<std::string> begun;
  std::map<std::string, wire::Waiting> told;
};

const PlaceRequest kAdmin{"a", true, false}, kBob{"bob", false, false}, kLive{"a", true, true};

TEST(Places, AreAsManyAsTheRulesSay) {
  Line line({2, 1, 0});
  EXPECT_TRUE(line.places.check(kAdmin).ok());
  line.places.began("1", kAdmin);
  line.places.began("2", kAdmin);
  const Status full = line.places.check(kAdmin);
  EXPECT_EQ(full.error().code, ErrorCode::kBusy);
  EXPECT_THAT(full.error().message, HasSubstr("at most 2 scans"));
  line.places.ended("1");
  EXPECT_TRUE(line.places.check(kAdmin).ok());
}

TEST(Places, OfATokenThatMayNotAdministerAreFewer) {
  Line line({4, 1, 0});
  line.places.began("1", kBob);
  EXPECT_THAT(line.places.check(kBob).error().message, HasSubstr("this token"));
  EXPECT_TRUE(line.places.check({"eve", false, false}).ok());
  EXPECT_TRUE(line.places.check(kAdmin).ok());
}

TEST(Places, GoToThoseWhoWaitInTheirOrder) {
  Line line({1, 1, 0});
  line.places.began("running", kAdmin);
  for (const char* scan : {"first", "second", "third"}) ASSERT_TRUE(line.wait(scan, kAdmin).ok());
  EXPECT_EQ(line.told["third"].before, 2u);
  line.end("running");
  EXPECT_THAT(line.begun, ElementsAre("first"));
  EXPECT_FALSE(line.places.check_for_newcomer(kAdmin).ok());
  line.end("first");
  line.end("second");
  EXPECT_THAT(line.begun, ElementsAre("first", "second", "third"));
  EXPECT_EQ(line.places.waiting_count(), 0u);
}

TEST(Places, ANewcomerPassesNobodyWhoCouldBegin) {
  Line line({2, 1, 0});
  line.places.began("1", kBob);
  line.places.began("2", kAdmin);
  ASSERT_TRUE(line.wait("bob's next", kBob).ok());
  line.places.ended("2");
  EXPECT_TRUE(line.places.check_for_newcomer(kAdmin).ok()) << "bob waits for his own scan to end";
  line.places.ended("1");
  EXPECT_THAT(line.places.check_for_newcomer(kAdmin).error().message, HasSubstr("1 cameras wait"));
  line.places.serve();
  EXPECT_THAT(line.begun, ElementsAre("bob's next"));
}

TEST(Places, WhoHasLeftTheLineIsForgotten) {
  Line line({1, 1, 0});
  line.places.began("running", kAdmin);
  const Result<Places::Ticket> ticket = line.wait("first", kAdmin);
  ASSERT_TRUE(line.wait("second", kAdmin).ok());
  line.places.leave(*ticket);
  line.end("running");
  EXPECT_THAT(line.begun, ElementsAre("second"));
}

TEST(Places, EverybodysTurnComesWhenThereWillBeNoMore) {
  Line line({1, 1, 0});
  line.places.began("running", kAdmin);
  for (const char* scan : {"first", "second"}) ASSERT_TRUE(line.wait(scan, kAdmin).ok());
  line.places.dismiss();
  EXPECT_THAT(line.begun, ElementsAre("first", "second"));
  EXPECT_EQ(line.places.waiting_count(), 0u);
}

TEST(Places, TheLineHasAnEnd) {
  Line line({1, 1, 0});
  line.places.began("running", kAdmin);
  for (std::size_t i = 0; static_cast<std::int64_t>(i) < kWaitingCameraShare.in_all; ++i)
    ASSERT_TRUE(line.wait(std::to_string(i), kAdmin).ok());
  EXPECT_EQ(line.wait("one too many", kAdmin).error().code, ErrorCode::kBusy);
}

TEST(Places, WhatIsKeptForAdministratorsKeepsNobodyElseInLine) {
  Line line({4, 4, 0});
  for (const char* scan : {"1", "2", "3"}) line.places.began(scan, kBob);
  EXPECT_THAT(line.places.check(kBob).error().message, HasSubstr("kept for administrators"));
  ASSERT_TRUE(line.wait("bob's next", kBob).ok());
  ASSERT_TRUE(line.wait("admin's", kAdmin).ok());
  line.places.serve();
  EXPECT_THAT(line.begun, ElementsAre("admin's"));
  line.end("1");
  EXPECT_THAT(line.begun, ElementsAre("admin's"))
      << "three places are taken, the fourth is no place of bob's";
  line.end("admin's");
  EXPECT_THAT(line.begun, ElementsAre("admin's", "bob's next"));
}

TEST(Places, ALiveScanHasNoneBesideItThatWouldStarveIt) {
  Line line({8, 8, 5});
  for (int i = 0; i < 100; ++i) line.places.frame_done(0.06);  // 60 ms a frame: 3 scans at 5 Hz
  EXPECT_TRUE(line.places.check(kLive).ok());
  line.places.began("1", kLive);
  line.places.began("2", kAdmin);
  EXPECT_TRUE(line.places.check(kAdmin).ok());
  line.places.began("3", kAdmin);
  EXPECT_THAT(line.places.check(kAdmin).error().message, HasSubstr("fewer than 5 frames a second"));
  line.places.ended("1");
  EXPECT_TRUE(line.places.check(kAdmin).ok()) << "without a live scan nobody is in a hurry";
  EXPECT_TRUE(line.places.check(kLive).ok());
}

TEST(Places, TheFirstScanHasAPlaceHoweverSlowTheDevice) {
  Line line({8, 8, 30});
  line.places.frame_done(10);
  EXPECT_TRUE(line.places.check(kLive).ok());
}

TEST(Places, AFrameBesideOthersCountsForLess) {
  Line line({8, 8, 5});
  line.places.began("1", kAdmin);
  line.places.began("2", kAdmin);
  line.places.frame_done(0.2);
  EXPECT_DOUBLE_EQ(line.places.frame_s(), 0.1);
}

// --- Device memory ---

constexpr std::uint64_t kMegabyte = 1'000'000;

// Without bounds of number or time.
PlaceRules within_memory(std::uint64_t mb = 0) { return {8, 8, 0, mb * kMegabyte}; }

TEST(Places, AreNoMoreThanTheDevicesMemoryHasRoomFor) {
  Line line(within_memory());
  line.places.began("1", kAdmin);
  line.places.memory_measured("1", 300 * kMegabyte, 1000 * kMegabyte);
  EXPECT_EQ(line.places.scan_gpu_memory_bytes(), 300 * kMegabyte)
      << "none has ended: what the largest that runs takes";
  line.places.began("2", kAdmin);
  EXPECT_TRUE(line.places.check(kAdmin).ok())
      << "the second counts as much though it takes nothing yet";
  line.places.began("3", kAdmin);
  const Status full = line.places.check(kAdmin);
  EXPECT_EQ(full.error().code, ErrorCode::kBusy);
  for (const char* message : {"come to 900 MB", "one more to 300 MB", "1000 MB for all"})
    EXPECT_THAT(full.error().message, HasSubstr(message));
  line.places.ended("3");
  EXPECT_TRUE(line.places.check(kAdmin).ok());
}

TEST(Places, AScanCountsForWhatItTakesWhenThatIsMoreThanUsual) {
  Line line(within_memory());
  line.places.began("1", kAdmin);
  line.places.memory_measured("1", 100 * kMegabyte, 1000 * kMegabyte);
  line.places.ended("1");
  line.places.began("2", kAdmin);
  line.places.memory_measured("2", 901 * kMegabyte, 1000 * kMegabyte);
  EXPECT_EQ(line.places.scan_gpu_memory_bytes(), 100 * kMegabyte);
  EXPECT_FALSE(line.places.check(kAdmin).ok());
  line.places.memory_measured("2", 900 * kMegabyte, 1000 * kMegabyte);
  EXPECT_TRUE(line.places.check(kAdmin).ok()) << "just enough";
}

TEST(Places, WhatAScanComesToIsTheMeanOfTheMostThatTheLastTook) {
  Line line(within_memory());
  const auto run = [&line](std::uint64_t most_mb) {
    line.places.began("scan", kAdmin);
    for (const std::uint64_t mb : {most_mb / 2, most_mb, most_mb / 4})
      line.places.memory_measured("scan", mb * kMegabyte, 0);
    line.places.ended("scan");
  };
  run(400);
  EXPECT_EQ(line.places.scan_gpu_memory_bytes(), 400 * kMegabyte);
  run(800);
  EXPECT_EQ(line.places.scan_gpu_memory_bytes(), 500 * kMegabyte);
  line.places.began("broken off before it was measured", kAdmin);
  line.places.ended("broken off before it was measured");
  EXPECT_EQ(line.places.scan_gpu_memory_bytes(), 500 * kMegabyte);
  for (int i = 0; i < 20; ++i) run(100);
  EXPECT_LT(line.places.scan_gpu_memory_bytes(), 105 * kMegabyte) << "one large scan is forgotten";
}

TEST(Places, TheFirstScanHasAPlaceHoweverLittleMemoryThereIs) {
  Line line(within_memory());
  line.places.began("1", kAdmin);
  line.places.memory_measured("1", 2000 * kMegabyte, 1000 * kMegabyte);
  EXPECT_FALSE(line.places.check(kAdmin).ok());
  line.places.ended("1");
  EXPECT_TRUE(line.places.check(kAdmin).ok());
}

TEST(Places, WhereNobodyKnowsTheMemoryNobodyWaitsForIt) {
  Line line(within_memory());
  line.places.began("1", kAdmin);
  EXPECT_TRUE(line.places.check(kAdmin).ok()) << "nothing was measured yet";
  line.places.memory_measured("1", 5000 * kMegabyte, 0);
  EXPECT_TRUE(line.places.check(kAdmin).ok()) << "a processor's memory is the host's";
}

TEST(Places, TheSettingGoesBeforeWhatTheDeviceHas) {
  Line line(within_memory(500));
  EXPECT_EQ(line.places.gpu_memory_bytes(), 500 * kMegabyte);
  line.places.began("1", kAdmin);
  line.places.memory_measured("1", 300 * kMegabyte, 8000 * kMegabyte);
  EXPECT_THAT(line.places.check(kAdmin).error().message, HasSubstr("500 MB for all"));
}

TEST(Places, TheLineMovesOnWhenMemoryIsFreeAgain) {
  Line line(within_memory());
  for (const char* scan : {"1", "2"}) {
    line.places.began(scan, kAdmin);
    line.places.memory_measured(scan, 400 * kMegabyte, 1000 * kMegabyte);
  }
  ASSERT_FALSE(line.places.check_for_newcomer(kAdmin).ok());
  for (const char* scan : {"first", "second"}) ASSERT_TRUE(line.wait(scan, kAdmin).ok());
  line.places.serve();
  EXPECT_TRUE(line.begun.empty());
  line.end("1");
  EXPECT_THAT(line.begun, ElementsAre("first"))
      << "it counts for 400 MB at once: there is no room for the second beside it";
  line.end("2");
  EXPECT_THAT(line.begun, ElementsAre("first", "second"));
}

TEST(Places, ThoseWhoWaitAreToldHowLong) {
  Line line({2, 2, 0});
  line.places.began("a", kAdmin);
  line.places.began("b", kAdmin);
  for (const char* scan : {"first", "second", "third"}) ASSERT_TRUE(line.wait(scan, kAdmin).ok());
  line.places.tell({std::numeric_limits<double>::infinity(), 12.3});
  EXPECT_EQ(line.told["first"].expected_s, 13u);
  EXPECT_EQ(line.told["second"].expected_s, 0u) << "nobody knows";
  EXPECT_EQ(line.told["third"].before, 2u);
}

}  // namespace
}  // namespace hermite::server
