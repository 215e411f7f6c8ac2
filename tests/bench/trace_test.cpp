#include "tests/bench/program/trace.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/bench/made_up.h"

namespace hermite::bench {
namespace {

nlohmann::json trace_of(const Measurement& measurement) {
  std::ostringstream text;
  write_trace(text, measurement);
  return nlohmann::json::parse(text.str());
}

std::vector<nlohmann::json> complete_events(const nlohmann::json& trace,
                                            const std::string& category) {
  std::vector<nlohmann::json> events;
  for (const nlohmann::json& event : trace.at("traceEvents"))
    if (event.at("ph") == "X" && event.at("cat") == category) events.push_back(event);
  return events;
}

TEST(Trace, HasAnEventForEveryFrameStageAndPassInMicroseconds) {
  const nlohmann::json trace = trace_of(made_up_measurement());
  const auto frames = complete_events(trace, "frame"), stages = complete_events(trace, "stage"),
             passes = complete_events(trace, "pass");
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].at("name"), "frame 7");
  EXPECT_EQ(frames[0].at("ts"), 0);
  EXPECT_EQ(frames[0].at("dur"), 10000);
  EXPECT_EQ(frames[0].at("args").at("tracked"), true);
  EXPECT_EQ(frames[1].at("ts"), 20000);
  EXPECT_EQ(frames[1].at("args").at("tracked"), false);
  ASSERT_EQ(stages.size(), 3u);
  EXPECT_EQ(stages[1].at("name"), "fuse");
  EXPECT_EQ(stages[1].at("ts"), 7000);
  EXPECT_EQ(stages[1].at("dur"), 2500);
  EXPECT_EQ(stages[1].at("tid"), frames[0].at("tid")) << "stages lie within their frame";
  ASSERT_EQ(passes.size(), 4u);
  EXPECT_EQ(passes[2].at("name"), "map/merge");
  EXPECT_EQ(passes[2].at("ts"), 7500);
  EXPECT_EQ(passes[2].at("args").at("invocations"), 100);
  EXPECT_NE(passes[2].at("tid"), frames[0].at("tid"));
}

TEST(Trace, NamesTheDeviceWhateverIsInItsName) {
  const nlohmann::json trace = trace_of(made_up_measurement());
  for (const nlohmann::json& event : trace.at("traceEvents"))
    if (event.at("name") == "process_name") {
      EXPECT_EQ(event.at("args").at("name"), "hermite on a \"device\"\n");
    }
}

TEST(Trace, OfNothingIsStillATrace) { EXPECT_TRUE(complete_events(trace_of({}), "frame").empty()); }

}  // namespace
}  // namespace hermite::bench
