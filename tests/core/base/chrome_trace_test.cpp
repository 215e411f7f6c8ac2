#include "core/base/chrome_trace.h"

#include <gtest/gtest.h>

#include <sstream>

namespace hermite {
namespace {

TEST(ChromeTrace, WritesMicrosecondsAndEscapesNames) {
  const Timeline::Clock::time_point zero{std::chrono::seconds(100)};
  std::ostringstream out;
  ChromeTrace trace(out, zero);
  trace.name_track(3, "a \"track\"\n");
  trace.add(
      {"back\\slash", "stage", 3, zero + std::chrono::milliseconds(5), 1.25, "{\"frame\":7}"});
  trace.finish();
  EXPECT_EQ(out.str(),
            "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n"
            "{\"ph\":\"M\",\"pid\":1,\"tid\":3,\"name\":\"thread_name\",\"args\":{\"name\":\"a "
            "\\\"track\\\"\\u000a\"}},\n"
            "{\"ph\":\"X\",\"pid\":1,\"tid\":3,\"ts\":5000.000,\"dur\":1250.000,\"cat\":\"stage\","
            "\"name\":\"back\\\\slash\","
            "\"args\":{\"frame\":7}}\n]}\n");
}

TEST(ChromeTrace, MayBeEmpty) {
  std::ostringstream out;
  ChromeTrace(out, {}).finish();
  EXPECT_EQ(out.str(), "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n\n]}\n");
}

}  // namespace
}  // namespace hermite
