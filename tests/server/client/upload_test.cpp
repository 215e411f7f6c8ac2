// The client's uploads against a real server, which comes and goes. What is sent is no recording.
#include "server/client/upload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::client {
namespace {

using testing::HasSubstr;

class UploadTest : public testing::Test {
 protected:
  UploadTest() {
    start();
    for (int i = 0; i < 10'000; ++i) bytes_ += static_cast<char>(i * i % 251);
    std::ofstream(folder_ / "noise", std::ios::binary) << bytes_;
  }
  void start() {
    server::ServiceOptions options = test::test_options(folder_ / "data");
    if (port_ != 0) options.listen = "127.0.0.1:" + std::to_string(port_);
    server_ = std::make_unique<test::RunningServer>(options);
    port_ = server_->port();
    target_.server = {"127.0.0.1", static_cast<std::uint16_t>(port_), server_->token(), false};
    target_.notes_folder = folder_ / "notes";
    target_.piece_bytes = 1000;
  }
  std::string stored(const std::string& id) {
    std::ifstream file(folder_ / ("data/uploads/" + id), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  std::ptrdiff_t count_in(const std::string& folder) {
    std::error_code none;
    return std::distance(std::filesystem::directory_iterator(folder_ / folder, none),
                         std::filesystem::directory_iterator());
  }
  // Gives up when so much has been sent.
  Result<std::string> send(std::int64_t give_up_at = -1) {
    bool enough = false;
    UploadObserver observer;
    observer.on_progress = [&](std::int64_t sent, std::int64_t) {
      sent_.push_back(sent);
      enough = enough || (give_up_at >= 0 && sent >= give_up_at);
      if (on_piece_) on_piece_(sent);
    };
    observer.interrupted = [&enough] { return enough; };
    observer.on_link = [this](const std::string& message) { link_.push_back(message); };
    return upload(*open_bytes(folder_ / "noise"), {{"filename", "noise"}}, target_, observer);
  }

  const test::TemporaryFolder folder_;
  std::unique_ptr<test::RunningServer> server_;
  int port_ = 0;
  UploadTarget target_;
  std::string bytes_;
  std::vector<std::int64_t> sent_;
  std::vector<std::string> link_;
  std::function<void(std::int64_t)> on_piece_;
};

TEST_F(UploadTest, ArrivesInPiecesAndBecomesAJob) {
  const Result<std::string> job = send();
  ASSERT_TRUE(job.ok()) << job.error().message;
  EXPECT_EQ(sent_.size(), 10u);
  EXPECT_EQ(stored(*job), bytes_);
  EXPECT_EQ(count_in("notes"), 0) << "what is done needs no note";
  const Result<JobReport> report =
      wait_for_job(target_, *job, [](const JobReport&) { return true; });
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->state, "failed");
  EXPECT_EQ(report->title, "noise");
  EXPECT_THAT(report->message, HasSubstr("no recording"));
  EXPECT_EQ(job_reports(target_)->size(), 1u);
  EXPECT_TRUE(change_job(target_, *job, true).ok());
}

TEST_F(UploadTest, AnotherRunGoesOnWhereTheFirstWasInterrupted) {
  ASSERT_FALSE(send(3000).ok());
  EXPECT_EQ(count_in("notes"), 1);
  sent_.clear();
  const Result<std::string> job = send();
  ASSERT_TRUE(job.ok()) << job.error().message;
  EXPECT_EQ(sent_.front(), 4000);
  EXPECT_EQ(stored(*job), bytes_);
  EXPECT_EQ(count_in("data/uploads"), 1);
}

TEST_F(UploadTest, AChangedFileIsAnotherUpload) {
  ASSERT_FALSE(send(3000).ok());
  bytes_ += "more";
  std::ofstream(folder_ / "noise", std::ios::binary) << bytes_;
  sent_.clear();
  const Result<std::string> job = send();
  ASSERT_TRUE(job.ok()) << job.error().message;
  EXPECT_EQ(sent_.front(), 1000);
  EXPECT_EQ(stored(*job), bytes_);
}

TEST_F(UploadTest, ANoteOfAnUploadThatIsGoneIsNoHindrance) {
  ASSERT_FALSE(send(3000).ok());
  server_.reset();
  std::filesystem::remove_all(folder_ / "data");
  start();
  EXPECT_TRUE(send().ok());
}

TEST_F(UploadTest, AServerThatIsRestartedMeanwhileIsGoneOnWith) {
  on_piece_ = [this](std::int64_t sent) {
    if (sent != 5000) return;
    server_.reset();
    start();
  };
  const Result<std::string> job = send();
  ASSERT_TRUE(job.ok()) << job.error().message;
  EXPECT_EQ(stored(*job), bytes_);
}

TEST_F(UploadTest, AServerThatStaysAwayIsGivenUp) {
  server_.reset();
  target_.patience = std::chrono::milliseconds(100);
  const Result<std::string> job = send();
  ASSERT_FALSE(job.ok());
  EXPECT_EQ(job.error().code, ErrorCode::kIo);
  EXPECT_THAT(job.error().message, HasSubstr("given up"));
  EXPECT_FALSE(link_.empty());
}

TEST_F(UploadTest, ARefusalIsFinalAndHasTheServersMessage) {
  target_.server.token = "wrong";
  const Result<std::string> job = send();
  ASSERT_FALSE(job.ok());
  EXPECT_EQ(job.error().code, ErrorCode::kUnauthorized);
  EXPECT_THAT(job.error().message, testing::Not(HasSubstr("wrong\"")));
  EXPECT_TRUE(link_.empty()) << "it was not tried again";
}

TEST_F(UploadTest, AFileThatShrinksMeanwhileIsAnError) {
  on_piece_ = [this](std::int64_t) { std::filesystem::resize_file(folder_ / "noise", 500); };
  const Result<std::string> job = send();
  ASSERT_FALSE(job.ok());
  EXPECT_THAT(job.error().message, HasSubstr("shorter"));
}

TEST_F(UploadTest, WhatIsNeitherFileNorFolderIsNamed) {
  EXPECT_EQ(open_bytes(folder_ / "none").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(open_bytes("/dev/null").error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace hermite::client
