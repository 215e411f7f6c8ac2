#include "server/slurm/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::server {
namespace {

using testing::HasSubstr;

TEST(Process, BothStreamsAndTheStatusAreTaken) {
  const Result<ProcessResult> result =
      run_process({"sh", "-c", "printf out; printf err >&2; read line; exit 3"});
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_EQ(result->output, "out");
  EXPECT_EQ(result->errors, "err");
  EXPECT_EQ(result->exit_status, 3) << "its input is empty";
}

TEST(Process, ASignalIsAStatus) {
  EXPECT_EQ(run_process({"sh", "-c", "kill -9 $$"})->exit_status, 128 + 9);
}

TEST(Process, ArgumentsAreNoShell) {
  EXPECT_EQ(run_process({"printf", "%s", "$(echo no) 'x'"})->output, "$(echo no) 'x'");
}

TEST(Process, WhatDoesNotEndIsKilledWithItsChildren) {
  ProcessLimits limits;
  limits.patience = std::chrono::milliseconds(200);
  const auto began = std::chrono::steady_clock::now();
  const Result<ProcessResult> result = run_process({"sh", "-c", "sleep 60 & sleep 60"}, limits);
  EXPECT_EQ(result.error().code, ErrorCode::kUnavailable);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(30));
}

TEST(Process, WhatPrintsWithoutEndIsKilled) {
  ProcessLimits limits;
  limits.max_bytes = 100'000;
  EXPECT_EQ(run_process({"yes"}, limits).error().code, ErrorCode::kTooLarge);
}

TEST(Process, AProgramThatIsNotThereIsNamed) {
  const Result<ProcessResult> result = run_process({"hermite-has-no-such-program"});
  EXPECT_EQ(result.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(result.error().message, HasSubstr("hermite-has-no-such-program"));
}

}  // namespace
}  // namespace hermite::server
