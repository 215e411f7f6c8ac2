// What every Executor keeps. An implementation is put through it with a world of its own:
//
//   struct World {
//     Executor& executor();
//     JobRow job(Work work);   // not submitted yet
//     void settle();           // until nothing happens any more by itself
//     void die();              // the process that does the jobs is killed, and started again
//     int done_count(id);      // how often the work of a job was brought to its end
//   };
//   INSTANTIATE_TYPED_TEST_SUITE_P(Local, ExecutorContract, World);
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "server/jobs/executor.h"
#include "server/store/scan_id.h"

namespace hermite::test {

enum class Work { kFinishes, kFails, kGoesOn, kLacksRoom };  // the last one until it is cancelled

template <class World>
class ExecutorContract : public testing::Test {
 protected:
  server::JobState state(const std::string& id) { return world_.executor().status(id)->row.state; }
  std::string submit(Work work) {
    const server::JobRow job = world_.job(work);
    EXPECT_TRUE(world_.executor().submit(job).ok());
    return job.id;
  }
  World world_;
};
TYPED_TEST_SUITE_P(ExecutorContract);

TYPED_TEST_P(ExecutorContract, AJobIsDoneOnceHoweverOftenItIsSubmitted) {
  const server::JobRow job = this->world_.job(Work::kFinishes);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(this->world_.executor().submit(job).ok());
    this->world_.settle();
  }
  EXPECT_EQ(this->state(job.id), server::JobState::kFinished);
  EXPECT_EQ(this->world_.done_count(job.id), 1);
  EXPECT_GT(this->world_.executor().status(job.id)->row.finished_at_ms, 0);
}

TYPED_TEST_P(ExecutorContract, AFailedOneSaysWhyAndIsTriedAgainWhenSubmittedAgain) {
  const server::JobRow job = this->world_.job(Work::kFails);
  ASSERT_TRUE(this->world_.executor().submit(job).ok());
  this->world_.settle();
  EXPECT_EQ(this->state(job.id), server::JobState::kFailed);
  EXPECT_FALSE(this->world_.executor().status(job.id)->row.message.empty());
  ASSERT_TRUE(this->world_.executor().submit(job).ok());
  EXPECT_EQ(this->state(job.id), server::JobState::kQueued);
  EXPECT_TRUE(this->world_.executor().status(job.id)->row.message.empty());
  this->world_.settle();
  EXPECT_EQ(this->world_.done_count(job.id), 2);
}

TYPED_TEST_P(ExecutorContract, WhatIsNotKnownIsNotFound) {
  for (const std::string& id : {server::new_scan_id(), std::string("x"), std::string()}) {
    EXPECT_EQ(this->world_.executor().status(id).error().code, ErrorCode::kNotFound);
    EXPECT_EQ(this->world_.executor().cancel(id).error().code, ErrorCode::kNotFound);
    EXPECT_EQ(this->world_.executor().log(id).error().code, ErrorCode::kNotFound);
  }
}

TYPED_TEST_P(ExecutorContract, AJobIsCancelledWhileItRuns) {
  const std::string id = this->submit(Work::kGoesOn);
  this->world_.settle();
  EXPECT_EQ(this->state(id), server::JobState::kRunning);
  EXPECT_TRUE(this->world_.executor().cancel(id).ok());
  EXPECT_EQ(this->state(id), server::JobState::kCancelled) << "at once";
  EXPECT_EQ(this->world_.executor().cancel(id).error().code, ErrorCode::kBusy);
  this->world_.settle();
  EXPECT_EQ(this->state(id), server::JobState::kCancelled);
  EXPECT_EQ(this->world_.done_count(id), 0);
}

TYPED_TEST_P(ExecutorContract, AJobIsCancelledWhileItWaits) {
  std::vector<std::string> running;
  for (int i = 0; i < 64; ++i) running.push_back(this->submit(Work::kGoesOn));
  const std::string id = this->submit(Work::kFinishes);
  EXPECT_TRUE(this->world_.executor().cancel(id).ok());
  for (const std::string& other : running) EXPECT_TRUE(this->world_.executor().cancel(other).ok());
  this->world_.settle();
  EXPECT_EQ(this->state(id), server::JobState::kCancelled);
  EXPECT_EQ(this->world_.done_count(id), 0);
}

TYPED_TEST_P(ExecutorContract, AFailedOneIsPutAwayAndMayBeTriedAgain) {
  const server::JobRow job = this->world_.job(Work::kFails);
  ASSERT_TRUE(this->world_.executor().submit(job).ok());
  this->world_.settle();
  const std::string message = this->world_.executor().status(job.id)->row.message;
  EXPECT_TRUE(this->world_.executor().cancel(job.id).ok());
  EXPECT_EQ(this->state(job.id), server::JobState::kCancelled);
  EXPECT_EQ(this->world_.executor().status(job.id)->row.message, message)
      << "what it failed of stays to be read";
  EXPECT_EQ(this->world_.executor().cancel(job.id).error().code, ErrorCode::kBusy);
  EXPECT_TRUE(this->world_.executor().submit(job).ok());
  this->world_.settle();
  EXPECT_EQ(this->state(job.id), server::JobState::kFailed);
}

TYPED_TEST_P(ExecutorContract, AFinishedOneCannotBeCancelled) {
  const std::string id = this->submit(Work::kFinishes);
  this->world_.settle();
  EXPECT_EQ(this->world_.executor().cancel(id).error().code, ErrorCode::kBusy);
  EXPECT_EQ(this->state(id), server::JobState::kFinished);
}

TYPED_TEST_P(ExecutorContract, TheListHasAllOfThemAndEachHasALog) {
  std::set<std::string> ids;
  for (const Work work : {Work::kFinishes, Work::kFails, Work::kGoesOn})
    ids.insert(this->submit(work));
  this->world_.settle();
  const Result<std::vector<server::JobStatus>> jobs = this->world_.executor().list();
  ASSERT_TRUE(jobs.ok());
  std::set<std::string> listed;
  for (const server::JobStatus& job : *jobs) listed.insert(job.row.id);
  EXPECT_EQ(listed, ids);
  for (const std::string& id : ids) {
    const Result<std::vector<server::JobLine>> log = this->world_.executor().log(id);
    ASSERT_TRUE(log.ok());
    EXPECT_FALSE(log->empty());
  }
}

TYPED_TEST_P(ExecutorContract, WhatWasSubmittedSurvivesADeathAndEndsOnce) {
  const std::string done = this->submit(Work::kFinishes);
  this->world_.settle();
  std::vector<std::string> waiting;
  for (int i = 0; i < 5; ++i) waiting.push_back(this->submit(Work::kFinishes));
  const std::string cancelled = this->submit(Work::kGoesOn);
  ASSERT_TRUE(this->world_.executor().cancel(cancelled).ok());
  this->world_.die();
  this->world_.settle();
  for (const std::string& id : waiting) {
    EXPECT_EQ(this->state(id), server::JobState::kFinished);
    EXPECT_EQ(this->world_.done_count(id), 1);
  }
  EXPECT_EQ(this->world_.done_count(done), 1);
  EXPECT_EQ(this->state(cancelled), server::JobState::kCancelled) << "it stays so";
}

TYPED_TEST_P(ExecutorContract, AJobThatKillsItsProcessIsGivenUpWithAMessage) {
  const std::string id = this->submit(Work::kGoesOn);
  for (int i = 0; i < 10; ++i) {
    this->world_.settle();
    this->world_.die();
  }
  this->world_.settle();
  EXPECT_EQ(this->state(id), server::JobState::kFailed);
  EXPECT_THAT(this->world_.executor().status(id)->row.message, testing::HasSubstr("times"));
}

REGISTER_TYPED_TEST_SUITE_P(ExecutorContract, AJobIsDoneOnceHoweverOftenItIsSubmitted,
                            AFailedOneSaysWhyAndIsTriedAgainWhenSubmittedAgain,
                            WhatIsNotKnownIsNotFound, AJobIsCancelledWhileItRuns,
                            AJobIsCancelledWhileItWaits, AFailedOneIsPutAwayAndMayBeTriedAgain,
                            AFinishedOneCannotBeCancelled, TheListHasAllOfThemAndEachHasALog,
                            WhatWasSubmittedSurvivesADeathAndEndsOnce,
                            AJobThatKillsItsProcessIsGivenUpWithAMessage);

}  // namespace hermite::test
