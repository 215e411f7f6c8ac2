#include "server/slurm/slurm_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "server/slurm/process.h"

namespace hermite::server::slurm_text_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// A line as squeue 22.05 prints it.
SlurmJob job_of(const std::string& state, const std::string& reason = "None") {
  const auto jobs =
      parse_squeue("7|hermite-a-1|" + state + "|2|3:0|node1|" + reason + "|\nnonsense\n");
  EXPECT_EQ(jobs.size(), 1u);
  return jobs.at(0);
}

TEST(SlurmText, AJobOfSqueueIsReadAndNonsenseLeftOut) {
  const SlurmJob job = job_of("RUNNING");
  EXPECT_EQ(job.number, "7");
  EXPECT_EQ(job.name, "hermite-a-1");
  EXPECT_EQ(job.restarts, 2);
  EXPECT_EQ(job.nodes, "node1");
  EXPECT_TRUE(parse_squeue("").empty());
  EXPECT_TRUE(parse_squeue("7|a|RUNNING|x|0||None|\n7|a|RUNNING|1|\n").empty());
  EXPECT_EQ(parse_squeue("7|a|PENDING|0|0||Priority|").at(0).nodes, "") << "without a line end";
}

TEST(SlurmText, EveryEndHasItsWords) {
  EXPECT_THAT(end_words(job_of("TIMEOUT")), HasSubstr("time limit"));
  EXPECT_THAT(end_words(job_of("OUT_OF_MEMORY")), HasSubstr("more memory"));
  EXPECT_THAT(end_words(job_of("NODE_FAIL")), AllOf(HasSubstr("node1"), HasSubstr("failed")));
  EXPECT_THAT(end_words(job_of("CANCELLED")), HasSubstr("scancel"));
  EXPECT_THAT(end_words(job_of("PREEMPTED")), HasSubstr("give way"));
  EXPECT_THAT(end_words(job_of("FAILED")), HasSubstr("exit status 3"));
  EXPECT_THAT(end_words(job_of("COMPLETED")), HasSubstr("without a result"));
  EXPECT_TRUE(lacked_memory(job_of("OUT_OF_MEMORY")));
  for (const char* state : {"TIMEOUT", "OUT_OF_MEMORY", "NODE_FAIL", "CANCELLED", "COMPLETED"})
    EXPECT_TRUE(is_over(job_of(state))) << state;
}

TEST(SlurmText, WhatWaitsSaysWhy) {
  EXPECT_EQ(wait_words(job_of("PENDING", "Resources")), "the cluster lets it wait: Resources");
  EXPECT_EQ(wait_words(job_of("PENDING")), "");
  EXPECT_EQ(wait_words(job_of("RUNNING", "Resources")), "");
  for (const char* state : {"PENDING", "CONFIGURING", "REQUEUED", "REQUEUE_HOLD", "RUNNING"})
    EXPECT_FALSE(is_over(job_of(state))) << state;
  EXPECT_TRUE(has_begun(job_of("COMPLETING")));
  EXPECT_FALSE(has_begun(job_of("CONFIGURING")));
}

TEST(SlurmText, TheServersEnvironmentStaysHere) {
  setenv("AWS_SECRET_ACCESS_KEY", "secret", 1);
  SlurmRequest request;
  request.name = "hermite-a-1";
  request.folder = "/shared/a";
  request.arguments = {"--gres=gpu:1"};
  request.time_limit_min = 30;
  request.memory_mb = 4000;
  const std::vector<std::string> command = sbatch_command(request);
  unsetenv("AWS_SECRET_ACCESS_KEY");
  EXPECT_THAT(command, AllOf(Contains("--job-name=hermite-a-1"), Contains("--gres=gpu:1"),
                             Contains("--time=30"), Contains("--mem=4000"), Contains("--requeue")));
  EXPECT_EQ(command.back(), "/shared/a/run.sh");
  for (const std::string& word : command) {
    EXPECT_THAT(word, Not(HasSubstr("SECRET")));
    EXPECT_THAT(word, Not(HasSubstr("ALL")));
  }
}

TEST(SlurmText, TheScriptIsTheProgramWhateverItsNameHas) {
  const std::string script = batch_script("printf", "/a b/it's $HOME");
  EXPECT_EQ(script, "#!/bin/sh\nexec 'printf' work '/a b/it'\\''s $HOME'\n");
  EXPECT_EQ(run_process({"sh", "-c", batch_script("echo", "/a b/it's $HOME")})->output,
            "work /a b/it's $HOME\n");
}

TEST(SlurmText, TheNumberOfAJobIsReadAndNothingElse) {
  EXPECT_EQ(*parse_job_number("12\n"), "12");
  EXPECT_EQ(*parse_job_number("12;cluster\n"), "12");
  for (const char* text : {"", "x", "12x", "-1", "Submitted batch job 12"})
    EXPECT_EQ(parse_job_number(text).error().code, ErrorCode::kCorruptData) << text;
}

TEST(SlurmText, WhatSlurmSaysIsOneShortLine) {
  EXPECT_EQ(said_words("sbatch: error: invalid partition specified: nope\n"
                       "sbatch: error: Batch job submission failed: Invalid partition name\n"),
            "invalid partition specified: nope; Batch job submission failed: Invalid partition "
            "name");
  EXPECT_LE(said_words(std::string(100'000, 'x')).size(), 300u);
}

}  // namespace
}  // namespace hermite::server::slurm_text_test
