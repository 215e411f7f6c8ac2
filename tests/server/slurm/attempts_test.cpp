#include "server/slurm/attempts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/dataset/text_file.h"
#include "server/store/scan_id.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server::attempts_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class AttemptsTest : public testing::Test {
 protected:
  AttemptsTest() {
    order_.job.id = new_scan_id();
    order_.job.source_id = new_scan_id();
    order_.job.scan_id = new_scan_id();
    order_.job.title = "It's a \"room\"";
    write("upload", "bytes");
    job_folder_ = folder_ / order_.job.id;
  }
  void write(const std::string& name, const std::string& text) {
    fs::create_directories(fs::path(folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  Attempt create() {
    const Result<Attempt> made =
        create_attempt(job_folder_, order_, {folder_ / "upload", "/usr/bin/hermite"});
    EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().message);
    return *made;
  }
  // As a run that has written a checkpoint.
  std::string run_of(const Attempt& attempt, int run, bool has_checkpoint) {
    const std::string folder = run_folder(attempt.folder, run),
                      scan = folder + "/scans/" + order_.job.scan_id;
    fs::create_directories(scan + "/log");
    if (has_checkpoint) std::ofstream(scan + "/checkpoint.bin") << "x";
    return folder;
  }

  const test::TemporaryFolder folder_;
  NodeOrder order_;
  std::string job_folder_;
};

TEST_F(AttemptsTest, AnAttemptHasItsOrderAndItsRecordingAndIsFoundAgain) {
  EXPECT_FALSE(open_attempt(job_folder_));
  const Attempt made = create();
  const std::optional<Attempt> found = open_attempt(job_folder_);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->folder, made.folder);
  EXPECT_EQ(found->name, made.name);
  EXPECT_EQ(found->number, 1);
  fs::remove(folder_ / "upload");
  EXPECT_EQ(*dataset::read_text_file(made.folder + "/recording"), "bytes")
      << "whatever becomes of the upload";
  const Result<NodeOrder> order = parse_order(*dataset::read_text_file(made.folder + "/job.json"));
  ASSERT_TRUE(order.ok());
  EXPECT_EQ(order->job.title, order_.job.title);
  EXPECT_EQ(order->name, made.name);
}

TEST_F(AttemptsTest, AClosedOneIsFollowedByAnotherWithAnotherName) {
  const Attempt first = create();
  ASSERT_TRUE(close_attempt(first.folder).ok());
  EXPECT_TRUE(is_closed(first.folder));
  EXPECT_FALSE(open_attempt(job_folder_));
  const Attempt second = create();
  EXPECT_EQ(second.number, 2);
  EXPECT_NE(second.name, first.name);
  EXPECT_FALSE(is_closed(second.folder));
  fs::remove_all(second.folder);
  EXPECT_TRUE(is_closed(second.folder)) << "so is one that was removed";
}

TEST_F(AttemptsTest, OneWithoutAnOrderWasNeverSubmittedAndIsNotUsed) {
  fs::remove(create().folder + "/job.json");
  EXPECT_FALSE(open_attempt(job_folder_));
  EXPECT_EQ(create().number, 2);
}

TEST_F(AttemptsTest, TheNumberIsKept) {
  const Attempt attempt = create();
  EXPECT_EQ(number_of(attempt), "");
  ASSERT_TRUE(keep_number(attempt, "17").ok());
  EXPECT_EQ(number_of(attempt), "17");
}

TEST_F(AttemptsTest, ARunGoesOnFromTheNewestEarlierCheckpointOnly) {
  const Attempt first = create();
  const std::string old = run_of(first, 0, true);
  const Attempt second = create();
  const auto from = [this](const Attempt& attempt, int run) {
    return run_to_go_on_from(attempt.folder, run, order_.job.scan_id);
  };
  EXPECT_EQ(from(first, 0), std::nullopt) << "not from itself";
  EXPECT_EQ(from(second, 0), old);
  run_of(second, 0, false);
  EXPECT_EQ(from(second, 1), old) << "the newer one has no checkpoint";
  const std::string newer = run_of(second, 1, true);
  EXPECT_EQ(from(second, 2), newer);
  EXPECT_EQ(from(first, 1), old) << "never from a later attempt";
  EXPECT_EQ(run_to_go_on_from(second.folder, 2, new_scan_id()), std::nullopt) << "of another scan";
  EXPECT_EQ(newest_run(second.folder), 1);
  EXPECT_EQ(newest_run(job_folder_), -1);
}

TEST_F(AttemptsTest, OutcomesAreReadAndWhatIsNoneIsRefused) {
  const Attempt attempt = create();
  const std::string run = run_of(attempt, 0, false);
  EXPECT_EQ(read_outcome(attempt.folder, 0).error().code, ErrorCode::kNotFound);
  NodeOutcome outcome;
  outcome.end = NodeEnd::kFinished;
  outcome.words = "no \xff UTF-8";
  outcome.lines = {"a line"};
  outcome.scan.title = "room";
  outcome.scan.camera = {160, 120, 131, 131, 79.5, 59.5, 5000};
  outcome.scan.frames_processed = 8;
  { std::ofstream(run + "/outcome.json") << format_outcome(outcome); }
  const Result<NodeOutcome> read = read_outcome(attempt.folder, 0);
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->end, NodeEnd::kFinished);
  EXPECT_EQ(read->scan.camera, outcome.scan.camera);
  EXPECT_EQ(read->scan.frames_processed, 8);
  EXPECT_EQ(read->lines, outcome.lines);
  for (const char* text : {"", "[]", "{}", "{\"end\": 1}", "{\"end\": \"finished\"}"})
    EXPECT_EQ(parse_outcome(text).error().code, ErrorCode::kCorruptData) << text;
  for (const char* text : {"", "[]", "{}", "{\"job\": \"../x\"}"})
    EXPECT_EQ(parse_order(text).error().code, ErrorCode::kCorruptData) << text;
  EXPECT_EQ(parse_stage("{\"stage\": \"tracking\", \"done\": 3, \"total\": 8}\n")->done, 3);
  EXPECT_FALSE(parse_stage("{\"stage\": \"tracking\"}").ok());
}

TEST_F(AttemptsTest, TheLastWordsAreTheEndOfWhatWasPrinted) {
  const Attempt attempt = create();
  EXPECT_EQ(last_words(attempt.folder), "");
  { std::ofstream(attempt.folder + "/output.txt") << "one line\n\n"; }
  EXPECT_EQ(last_words(attempt.folder), "one line");
  { std::ofstream(attempt.folder + "/output.txt") << std::string(100'000, 'x') << "end\n"; }
  EXPECT_LE(last_words(attempt.folder).size(), 200u);
  EXPECT_TRUE(last_words(attempt.folder).ends_with("xend"));
}

TEST_F(AttemptsTest, FilesAreLinkedOrCopied) {
  write("log/0001", "frames");
  ASSERT_TRUE(link_files(folder_ / "log", folder_ / "linked").ok());
  ASSERT_TRUE(copy_files(folder_ / "log", folder_ / "copied").ok());
  ASSERT_TRUE(link_files(folder_ / "log", folder_ / "linked").ok()) << "again";
  { std::ofstream(folder_ / "log/0001", std::ios::app) << "+"; }
  EXPECT_EQ(*dataset::read_text_file(folder_ / "linked/0001"), "frames+");
  EXPECT_EQ(*dataset::read_text_file(folder_ / "copied/0001"), "frames");
  EXPECT_EQ(link_files(folder_ / "none", folder_ / "x").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace hermite::server::attempts_test
