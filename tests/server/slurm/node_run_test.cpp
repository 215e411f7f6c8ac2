// What a node does in the folder of an attempt, in this process; tests/faults/slurm_jobs.py has
// real nodes.
#include "server/slurm/node_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/dataset/text_file.h"
#include "core/dataset/write_raw.h"
#include "core/source/open_sequence.h"
#include "server/slurm/attempts.h"
#include "server/slurm/take_result.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server::node_run_test {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

class NodeRunTest : public testing::Test {
 protected:
  // Writes a recording of so many frames, and the attempt of a job for it.
  Attempt attempt_of(int frames) {
    const auto room = *source::open_sequence("synthetic:width=160,height=120,seed=1,frames=" +
                                             std::to_string(frames));
    const std::string path = folder_ / "room.raw";
    EXPECT_TRUE(dataset::write_raw(*room, {0, frames}, path, [](std::int64_t) {}).ok());
    NodeOrder order;
    order.job.id = new_scan_id();
    order.job.source_id = new_scan_id();
    order.job.scan_id = scan_id_;
    order.job.title = "room";
    order.checkpoint_period_ms = 60'000;
    job_folder_ = folder_ / order.job.id;
    order_ = order;
    return next_attempt();
  }
  Attempt next_attempt() {
    return *create_attempt(job_folder_, order_, {folder_ / "room.raw", "hermite"});
  }
  // Until so many frames are done, the run is left alone; then it is told to leave.
  Result<NodeOutcome> run_until(const Attempt& attempt, int run, std::int64_t frames) {
    std::atomic<bool> stop = false;
    Result<NodeOutcome> outcome = Error{};
    std::thread node([&] { outcome = run_on_node(attempt.folder, run, stop); });
    for (int i = 0; i < 3000 && !stop; ++i) {
      const Result<JobStage> stage = read_progress(attempt.folder, run);
      stop = stage.ok() && stage->name == "tracking" && stage->done >= frames;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    stop = true;
    node.join();
    return outcome;
  }
  std::pair<std::string, std::string> hashes_in(const std::string& folder) {
    const auto report =
        nlohmann::json::parse(*dataset::read_text_file(folder + "/report.json"), nullptr, false);
    return {report.value("trajectory_sha256", ""), report.value("cloud_sha256", "")};
  }

  const std::atomic<bool> never_ = false;
  const test::TemporaryFolder folder_;
  const std::string scan_id_ = new_scan_id();
  NodeOrder order_;
  std::string job_folder_;
};

TEST_F(NodeRunTest, ARecordingEndsAsTheFilesOfAScanWhichAreTakenInAsOftenAsOneLikes) {
  const Attempt attempt = attempt_of(6);
  const Result<NodeOutcome> outcome = run_on_node(attempt.folder, 0, never_);
  ASSERT_TRUE(outcome.ok()) << outcome.error().message;
  EXPECT_EQ(outcome->end, NodeEnd::kFinished) << outcome->words;
  EXPECT_EQ(outcome->scan.frames_processed, 6);
  EXPECT_EQ(outcome->scan.camera.width, 160);
  EXPECT_GT(outcome->peak_memory_bytes, 0u);
  EXPECT_TRUE(read_outcome(attempt.folder, 0).ok());
  EXPECT_EQ(run_on_node(attempt.folder, 0, never_).error().code, ErrorCode::kBusy)
      << "a run is done once";
  const std::string result = run_folder(attempt.folder, 0) + "/result";
  const DataDirectory data(folder_ / "data");
  FileBlobs blobs(data.scans_folder());
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(take_result(result, scan_id_, data, blobs).ok());
  EXPECT_EQ(hashes_in(data.scan_folder(scan_id_)), hashes_in(result));
  for (const char* name : {"cloud.ply", "chunks.bin", "thumbnail.jpg", "trajectory.txt"})
    EXPECT_TRUE(blobs.size_bytes(scan_id_, name).ok()) << name;
  EXPECT_FALSE(fs::is_empty(data.log_folder(scan_id_)));
  EXPECT_FALSE(take_result(result + "/none", scan_id_, data, blobs).ok());
}

TEST_F(NodeRunTest, OneThatIsToldToLeaveIsFollowedByOneThatGoesOnToTheSameResult) {
  const Attempt attempt = attempt_of(60);
  ASSERT_EQ(run_until(attempt, 0, 5)->end, NodeEnd::kStopped);
  const auto hashes_of = [this](const Attempt& one, int run, bool goes_on) {
    const Result<NodeOutcome> outcome = run_on_node(one.folder, run, never_);
    EXPECT_TRUE(outcome.ok() && outcome->end == NodeEnd::kFinished);
    EXPECT_EQ(testing::Matches(Contains(HasSubstr("goes on from a checkpoint")))(outcome->lines),
              goes_on);
    EXPECT_EQ(testing::Matches(Contains(HasSubstr("goes on with frame")))(outcome->lines), goes_on);
    return hashes_in(run_folder(one.folder, run) + "/result");
  };
  const auto requeued = hashes_of(attempt, 1, true);
  EXPECT_FALSE(requeued.first.empty());
  ASSERT_TRUE(close_attempt(attempt.folder).ok());
  EXPECT_EQ(requeued, hashes_of(next_attempt(), 0, true)) << "another attempt";
  fs::remove_all(job_folder_);
  EXPECT_EQ(requeued, hashes_of(next_attempt(), 0, false)) << "without a checkpoint";
}

TEST_F(NodeRunTest, AnAttemptThatWasGivenUpIsNotBegunAndABadRecordingSaysWhy) {
  const Attempt attempt = attempt_of(2);
  ASSERT_TRUE(close_attempt(attempt.folder).ok());
  EXPECT_EQ(run_on_node(attempt.folder, 0, never_).error().code, ErrorCode::kBusy);
  EXPECT_EQ(newest_run(attempt.folder), -1) << "and nothing is written";
  EXPECT_EQ(run_on_node(folder_ / "none", 0, never_).error().code, ErrorCode::kNotFound);
  fs::resize_file(folder_ / "room.raw", 100);
  const Result<NodeOutcome> bad = run_on_node(next_attempt().folder, 0, never_);
  ASSERT_TRUE(bad.ok());
  EXPECT_EQ(bad->end, NodeEnd::kFailed);
  EXPECT_FALSE(bad->words.empty());
}

}  // namespace
}  // namespace hermite::server::node_run_test
