// The part of Store that is about jobs and uploads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/support/temporary_folder.h"

namespace hermite {
namespace {

class StoreJobsTest : public testing::Test {
 protected:
  JobRow add(int priority, std::int64_t created_at_ms, JobState state = JobState::kQueued) {
    JobRow row;
    row.id = new_scan_id();
    row.token_id = "t";
    row.title = "a 'title'";
    row.source_id = row.id;
    row.priority = priority;
    row.state = state;
    row.created_at_ms = created_at_ms;
    EXPECT_TRUE(store_->add_job(row).ok());
    return row;
  }
  void open_again() {
    store_.reset();
    store_ = std::make_unique<Store>(folder_ / "db");
  }

  const test::TemporaryFolder folder_;
  std::unique_ptr<Store> store_ = std::make_unique<Store>(folder_ / "db");
};

TEST_F(StoreJobsTest, AJobComesBackAsItWasOverARestart) {
  JobRow row = add(7, 1000);
  row.state = JobState::kFailed;
  row.words = "no 'camera'";
  row.attempt_count = 2;
  row.scan_id = new_scan_id();
  row.started_at_ms = 2000;
  row.finished_at_ms = 3000;
  ASSERT_TRUE(store_->update_job(row).ok());
  open_again();
  const Result<JobRow> found = store_->job(row.id);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->title, row.title);
  EXPECT_EQ(found->words, row.words);
  EXPECT_EQ(found->state, JobState::kFailed);
  EXPECT_EQ(found->priority, 7);
  EXPECT_EQ(found->attempt_count, 2);
  EXPECT_EQ(found->scan_id, row.scan_id);
  EXPECT_EQ(found->finished_at_ms, 3000);
}

TEST_F(StoreJobsTest, TheNextOneIsTheHighestAndThenTheOldest) {
  const JobRow late = add(0, 2000), early = add(0, 1000), urgent = add(5, 3000), last = add(-5, 0);
  add(99, 0, JobState::kFinished);
  const Result<std::vector<JobRow>> rows = store_->jobs_in(JobState::kQueued);
  ASSERT_TRUE(rows.ok());
  std::vector<std::string> ids;
  for (const JobRow& row : *rows) ids.push_back(row.id);
  EXPECT_THAT(ids, testing::ElementsAre(urgent.id, early.id, late.id, last.id));
}

TEST_F(StoreJobsTest, JobsAreCountedByState) {
  for (int i = 0; i < 3; ++i) add(0, 1000);
  add(0, 1000, JobState::kFailed);
  const auto counts = store_->count_jobs();
  ASSERT_TRUE(counts.ok());
  EXPECT_EQ(
      *counts,
      (std::map<JobState, int>{
          {JobState::kQueued, 3}, {JobState::kRunning, 0}, {JobState::kFinished, 0}, {JobState::kFailed, 1}, {JobState::kCancelled, 0}}));
}

TEST_F(StoreJobsTest, AnIdIsThereOnce) {
  const JobRow row = add(0, 0);
  EXPECT_EQ(store_->add_job(row).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(store_->job("x").error().code, ErrorCode::kNotFound);
}

TEST_F(StoreJobsTest, TheLogIsBounded) {
  const JobRow row = add(0, 0);
  for (int i = 0; i < kMaxJobLines + 50; ++i) ASSERT_TRUE(store_->add_job_line(row.id, {i, "line " + std::to_string(i)}).ok());
  const Result<std::vector<JobLine>> lines = store_->job_lines(row.id);
  ASSERT_TRUE(lines.ok());
  ASSERT_EQ(lines->size(), static_cast<std::size_t>(kMaxJobLines + 1));
  EXPECT_EQ(lines->front().words, "line 0");
  EXPECT_EQ(lines->back().words, "what follows is left out");
  EXPECT_EQ(store_->add_job_line("x", {0, "y"}).error().code, ErrorCode::kNotFound);
}

TEST_F(StoreJobsTest, OldJobsAreForgottenWithTheirLogs) {
  JobRow old = add(0, 0, JobState::kFinished), waiting = add(0, 0);
  ASSERT_TRUE(store_->add_job_line(old.id, {0, "x"}).ok());
  old.finished_at_ms = 10;
  ASSERT_TRUE(store_->update_job(old).ok());
  EXPECT_EQ(*store_->forget_jobs(11), 1);
  EXPECT_FALSE(store_->job(old.id).ok());
  EXPECT_TRUE(store_->job_lines(old.id)->empty());
  EXPECT_TRUE(store_->job(waiting.id).ok());
}

TEST_F(StoreJobsTest, AScanOfAJobIsNoneThatTheServerGoesOnWith) {
  ScanRow scan;
  scan.id = new_scan_id();
  ASSERT_TRUE(store_->add(scan).ok());
  EXPECT_EQ(store_->running()->size(), 1u);
  JobRow job = add(0, 0);
  job.scan_id = scan.id;
  ASSERT_TRUE(store_->update_job(job).ok());
  EXPECT_TRUE(store_->running()->empty());
}

TEST_F(StoreJobsTest, AnUploadComesBackAsItWasOverARestart) {
  UploadRow row{new_scan_id(), "t", -1, "filename Zg==", -1, 1, 2};
  ASSERT_TRUE(store_->add_upload(row).ok());
  row.length_bytes = 5;
  row.unchecked_from = 3;
  row.expires_at_ms = 9;
  ASSERT_TRUE(store_->update_upload(row).ok());
  open_again();
  const Result<UploadRow> found = store_->upload(row.id);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->length_bytes, 5);
  EXPECT_EQ(found->unchecked_from, 3);
  EXPECT_EQ(found->expires_at_ms, 9);
  EXPECT_EQ(found->metadata, "filename Zg==");
  EXPECT_EQ(store_->list_uploads()->size(), 1u);
  EXPECT_TRUE(store_->remove_upload(row.id).ok());
  EXPECT_EQ(store_->remove_upload(row.id).error().code, ErrorCode::kNotFound);
}

TEST_F(StoreJobsTest, ThereAreOnlySoManyUploads) {
  for (int i = 0; i < kMaxUploads; ++i) ASSERT_TRUE(store_->add_upload({new_scan_id(), "t", 1, "", -1, 0, 0}).ok());
  EXPECT_EQ(store_->add_upload({new_scan_id(), "t", 1, "", -1, 0, 0}).error().code, ErrorCode::kBusy);
}

}  // namespace
}  // namespace hermite
