#include "server/client/load_machine.h"

#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace hermite::client {
namespace {

TEST(LoadMachine, CountsItsWork) {
  const double thread_before_s = thread_cpu_s(), process_before_s = process_cpu_s();
  while (thread_cpu_s() < thread_before_s + 0.01) continue;
  EXPECT_GT(process_cpu_s(), process_before_s + 0.005) << "the two clocks do not tick together";
}

TEST(LoadMachine, KnowsItsOwnAddresses) {
  EXPECT_TRUE(is_this_machine({"127.0.0.1", 8080, ""}));
  EXPECT_FALSE(is_this_machine({"192.0.2.1", 8080, ""}))
      << "an address of nobody, for documentation";
  EXPECT_FALSE(is_this_machine({std::string(300, 'a'), 8080, ""})) << "longer than a name may be";
}

TEST(LoadMachine, SaysWhenTheSystemAllowsTooFewFiles) {
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &limit), 0);
  EXPECT_TRUE(allow_open_files(10).ok());
  if (limit.rlim_max == RLIM_INFINITY) GTEST_SKIP() << "there is no limit here";
  const Status status = allow_open_files(limit.rlim_max + 1);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kTooLarge);
  EXPECT_THAT(status.error().message,
              testing::HasSubstr("this process " + std::to_string(limit.rlim_max)));
}

}  // namespace
}  // namespace hermite::client
