#include "server/operations/frame_traces.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace hermite::server {
namespace {

using Time = Timeline::Clock::time_point;
using std::chrono::seconds;

nlohmann::json events_of(const FrameTraces& traces, const std::string& scan) {
  return nlohmann::json::parse(*traces.chrome_json(scan)).at("traceEvents");
}

int count(const nlohmann::json& events, const char* phase) {
  int found = 0;
  for (const nlohmann::json& event : events) found += event.at("ph") == phase;
  return found;
}

TEST(FrameTraces, EachStageHasItsTrack) {
  FrameTraces traces;
  const Time start{seconds(1000)};
  traces.add("a", 7, {{"decode", start + seconds(1), 2}, {"queue", start, 1000}});
  traces.add("a", 8, {{"decode", start + seconds(2), 3}});
  const nlohmann::json events = events_of(traces, "a");
  EXPECT_EQ(count(events, "M"), 3);
  ASSERT_EQ(count(events, "X"), 3);
  EXPECT_EQ(events.back().at("args").at("frame"), 8);
  EXPECT_EQ(events.back().at("ts"), 2e6) << "since the earliest";
  EXPECT_EQ(events.back().at("dur"), 3000);
  EXPECT_FALSE(traces.chrome_json("b").ok());
}

TEST(FrameTraces, SpansThatOverlapGoSideBySide) {
  FrameTraces traces;
  const Time start{seconds(1000)};
  traces.add("a", 0, {{"queue", start, 5000}});
  traces.add("a", 1, {{"queue", start + seconds(1), 5000}});
  traces.add("a", 2, {{"queue", start + seconds(5), 5000}});
  const nlohmann::json events = events_of(traces, "a");
  std::vector<int> tracks;
  for (const nlohmann::json& event : events)
    if (event.at("ph") == "X") tracks.push_back(event.at("tid"));
  EXPECT_EQ(tracks, (std::vector<int>{1, 2, 1}));
}

TEST(FrameTraces, OnlyTheLastMinuteIsKept) {
  FrameTraces traces;
  for (int i = 0; i < 200; ++i)
    traces.add("a", static_cast<std::uint64_t>(i), {{"track", Time{seconds(i)}, 5}});
  const nlohmann::json events = events_of(traces, "a");
  EXPECT_EQ(count(events, "X"), 61);
  EXPECT_EQ(events.back().at("args").at("frame"), 199);
}

TEST(FrameTraces, MemoryIsBoundedInSpansAndScans) {
  FrameTraces traces;
  const std::vector<Timeline::Stage> many(1000, {"track", Time{seconds(1)}, 0.001});
  for (int i = 0; i < 100; ++i) traces.add("a", 0, many);
  EXPECT_EQ(static_cast<std::size_t>(count(events_of(traces, "a"), "X")), kMaxTracedSpans);
  for (std::size_t i = 0; i < kMaxTracedScans; ++i)
    traces.add("scan " + std::to_string(i), 0,
               {{"track", Time{seconds(2 + static_cast<int>(i))}, 1}});
  EXPECT_FALSE(traces.chrome_json("a").ok()) << "the one that was silent for longest";
  EXPECT_TRUE(traces.chrome_json("scan 0").ok());
}

}  // namespace
}  // namespace hermite::server
