#include "core/pipeline/doctor.h"

#include <gtest/gtest.h>

namespace hermite::pipeline::doctor_test {
namespace {

TEST(Doctor, ADeviceThatIsNotThereIsAProblemWithAMessage) {
  const DeviceReport report = examine_device("a device that nobody has");
  ASSERT_FALSE(report.problems.empty());
  EXPECT_NE(report.problems.front().find("a device that nobody has"), std::string::npos)
      << report.problems.front();
}

TEST(Doctor, SaysWhichDeviceItUses) {
  const DeviceReport report = examine_device("");
  if (!report.problems.empty()) GTEST_SKIP() << "no fit GPU here: " << report.problems.front();
  bool named = false;
  for (const std::string& fact : report.facts) named = named || fact.rfind("using ", 0) == 0;
  EXPECT_TRUE(named);
}

}  // namespace
}  // namespace hermite::pipeline::doctor_test
