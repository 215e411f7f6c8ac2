// Recordings that become scans: a real server, real uploads, the real client. The same frames
// streamed give the same bits.
#include "server/jobs/scan_job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/dataset/write_raw.h"
#include "core/dataset/write_tum.h"
#include "core/source/open_sequence.h"
#include "server/client/api_request.h"
#include "server/client/stream.h"
#include "server/client/upload.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/core/dataset/oni_bytes.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class ScanJobTest : public testing::Test {
 protected:
  ScanJobTest() { start(); }
  void start(int storage_gb = 0, int min_free_disk_mb = 0) {
    server_.reset();
    ServiceOptions options = test::test_options(folder_ / "data");
    options.drain_s = 0;
    options.storage_gb = storage_gb;
    options.min_free_disk_mb = min_free_disk_mb;
    options.admin_listen = "127.0.0.1:0";
    server_ = std::make_unique<test::RunningServer>(options);
  }
  // With the result of an earlier scan, while no server runs.
  void fill_storage(std::uint64_t bytes) {
    server_.reset();
    ScanRow row;
    row.id = new_scan_id();
    row.phase = ScanPhase::kFinished;
    row.camera = {160, 120, 131, 131, 79.5, 59.5, 5000};
    ASSERT_TRUE(Store(folder_ / "data/hermite.db").scans.add(row).ok());
    const std::string file = folder_ / "data/scans/" + row.id + "/cloud.ply";
    std::filesystem::create_directory(folder_ / "data/scans/" + row.id);
    { std::ofstream cloud(file); }
    std::filesystem::resize_file(file, bytes);  // sparse
  }
  client::UploadTarget target() const {
    client::UploadTarget target;
    target.server = {"127.0.0.1", static_cast<std::uint16_t>(server_->port()), server_->token(),
                     false};
    return target;
  }
  std::string recording(int frames) {
    const std::string path = folder_ / ("room" + std::to_string(frames));
    const auto sequence = *source::open_sequence("synthetic:width=160,height=120,seed=1,frames=" +
                                                 std::to_string(frames));
    const auto range = *dataset::parse_frame_range("", frames);
    EXPECT_TRUE(dataset::write_tum(*sequence, range, path, [](std::int64_t) {}).ok());
    return path;
  }
  std::string send(const std::string& path, const client::UploadMetadata& metadata = {}) {
    const Result<std::string> job =
        client::upload(*client::open_bytes(path), metadata, target(), {});
    EXPECT_TRUE(job.ok()) << (job.ok() ? "" : job.error().message);
    return *job;
  }
  client::JobReport end_of(const std::string& job) {
    return *client::wait_for_job(target(), job, [](const client::JobReport&) { return true; });
  }
  json get(const std::string& path) {
    return json::parse(*client::api_request(target().server, "GET", "/api/v1/" + path, ""));
  }
  std::pair<std::string, std::string> hashes(const json& report) {
    return {report["trajectory_sha256"], report["cloud_sha256"]};
  }
  // Until the job has a scan that so many frames were processed of.
  bool runs(const std::string& job, std::int64_t frames) {
    for (int i = 0; i < 2000; ++i) {
      const client::JobReport report = *client::job_report(target(), job);
      if (report.ended()) return false;
      if (report.stage == "tracking" && report.done >= frames) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  const test::TemporaryFolder folder_;
  std::unique_ptr<test::RunningServer> server_;
};

TEST_F(ScanJobTest, GivesTheBitsThatStreamingGivesAndSoDoesDoingItAgain) {
  const std::string path = recording(8);
  const client::JobReport report = end_of(send(path, {{"filename", "room"}}));
  ASSERT_EQ(report.state, "finished") << report.message;
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "data/uploads")) << "what was used up goes";
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "data/jobs"));
  const auto of_job = hashes(get("scans/" + report.scan + "/report.json"));

  const auto sequence = *source::open_sequence(path);
  client::StreamRequest request;
  request.server = target().server;
  const Result<client::StreamOutcome> streamed = client::stream_sequence(
      *sequence, *dataset::parse_frame_range("", sequence->frame_count()), request, {});
  ASSERT_TRUE(streamed.ok());
  EXPECT_EQ(of_job, hashes(json::parse(streamed->report_json)));

  const std::string body = R"({"scan": ")" + report.scan + R"("})";
  const client::JobReport again = end_of(
      json::parse(*client::api_request(target().server, "POST", "/api/v1/jobs", body))["id"]);
  ASSERT_EQ(again.state, "finished") << again.message;
  EXPECT_EQ(of_job, hashes(get("scans/" + again.scan + "/report.json")));

  const std::string other =
      R"({"scan": ")" + report.scan + R"(", "settings": {"map.stable_confidence": "1"}})";
  const client::JobReport changed = end_of(
      json::parse(*client::api_request(target().server, "POST", "/api/v1/jobs", other))["id"]);
  ASSERT_EQ(changed.state, "finished") << changed.message;
  EXPECT_NE(of_job.second, hashes(get("scans/" + changed.scan + "/report.json")).second);
}

TEST_F(ScanJobTest, AnUploadThatFillsTheStorageIsStillMadeIntoAScanAndTheNextOneIsRefused) {
  const std::string path = folder_ / "room.raw", longer = folder_ / "longer.raw";
  const auto room = *source::open_sequence("synthetic:width=160,height=120,frames=3");
  ASSERT_TRUE(dataset::write_raw(*room, {0, 2}, path, [](std::int64_t) {}).ok());
  ASSERT_TRUE(dataset::write_raw(*room, {0, 3}, longer, [](std::int64_t) {}).ok());
  fill_storage(1'000'000'000 - std::filesystem::file_size(path));
  start(1);
  const client::JobReport report = end_of(send(path));
  EXPECT_EQ(report.state, "finished") << report.message;
  client::UploadTarget impatient = target();
  impatient.patience = std::chrono::seconds(0);
  const Result<std::string> refused =
      client::upload(*client::open_bytes(longer), {}, impatient, {});
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("the scans and uploads on this server take"));
  test::RawClient admin(server_->service().admin_port());
  admin.send("GET /metrics HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(admin.read_to_end(), HasSubstr("hermite_jobs{state=\"finished\"} 1\n"));
}

TEST_F(ScanJobTest, ARecordingOfOpenNiIsTakenAlone) {
  const std::string path = folder_ / "room.oni";
  const auto bytes =
      test::oni_bytes(**source::open_sequence("synthetic:width=160,height=120,frames=3"));
  {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  const client::JobReport report = end_of(send(path, {{"filename", "room.oni"}}));
  EXPECT_EQ(report.state, "finished") << report.message;
  EXPECT_EQ(report.title, "room");
  EXPECT_EQ(get("scans/" + report.scan + "/report.json")["frames"], 3);
}

TEST_F(ScanJobTest, ABadRecordingSaysWhyAndLeavesNothing) {
  std::ofstream(folder_ / "bad.tar") << "no recording";
  const client::JobReport bad = end_of(send(folder_ / "bad.tar", {{"filename", "bad.tar"}}));
  EXPECT_EQ(bad.state, "failed");
  EXPECT_THAT(bad.message, HasSubstr("bad is no recording we know"));
  const std::string path = recording(3);
  std::filesystem::remove(path + "/camera.json");
  const client::JobReport blind = end_of(send(path));
  EXPECT_EQ(blind.state, "failed");
  EXPECT_THAT(blind.message, HasSubstr("camera"));
  EXPECT_THAT(blind.message, testing::Not(HasSubstr(folder_.path())))
      << "paths of the server are nobody's business";
  EXPECT_EQ(get("scans")["scans"].size(), 0u);
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "data/scans"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "data/jobs"));
}

TEST_F(ScanJobTest, ACancelledOneLeavesNothingAndCanBeTriedAgain) {
  const std::string job = send(recording(60));
  ASSERT_TRUE(runs(job, 1));
  const std::string scan = client::job_report(target(), job)->scan;
  EXPECT_EQ(get("scans/" + scan)["state"], "running") << "it is in the list while it runs";
  ASSERT_TRUE(client::change_job(target(), job, false).ok());
  EXPECT_EQ(client::job_report(target(), job)->state, "cancelled");
  for (int i = 0; i < 1000 && !get("scans")["scans"].empty(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "data/scans"));
  Result<client::JobReport> again = client::change_job(target(), job, true);
  for (int i = 0; i < 1000 && !again.ok(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    again = client::change_job(target(), job, true);
  }
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_TRUE(runs(job, 1));
  client::change_job(target(), job, false).ok();
}

TEST_F(ScanJobTest, OneThatTheDiskHasNoRoomForWaitsAndIsDoneWhenThereIsSome) {
  const std::string job = send(recording(20));
  ASSERT_TRUE(runs(job, 1));
  server_.reset();
  std::filesystem::remove_all(folder_ / "data/scans/" +
                              Store(folder_ / "data/hermite.db").jobs.find(job)->scan_id);
  const auto free_mb =
      static_cast<int>(std::filesystem::space(folder_ / "data").available / 1'000'000);
  start(0, free_mb + 500);  // other files take more than that: if they went there would be room
  client::JobReport report;
  for (int i = 0; i < 500 && report.message.empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    report = *client::job_report(target(), job);
  }
  EXPECT_EQ(report.state, "queued");
  EXPECT_THAT(report.message, HasSubstr("the disk has room for 0 MB"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "data/jobs"));
  start();
  EXPECT_EQ(end_of(job).state, "finished");
}

TEST_F(ScanJobTest, OneThatNoDiskOfThisSizeHasRoomForFailsAtOnce) {
  const std::string job = send(recording(20));
  ASSERT_TRUE(runs(job, 1));
  server_.reset();
  std::filesystem::remove_all(folder_ / "data/scans/" +
                              Store(folder_ / "data/hermite.db").jobs.find(job)->scan_id);
  start(0, 1'000'000'000);  // more must stay free than the disk has
  const client::JobReport report = end_of(job);
  EXPECT_EQ(report.state, "failed");
  EXPECT_THAT(report.message, HasSubstr("the disk could have room for"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "data/jobs"));
}

TEST_F(ScanJobTest, AServerThatStopsIsFollowedByOneThatGoesOnWithTheSameScan) {
  const std::string path = recording(40);
  const std::string job = send(path);
  ASSERT_TRUE(runs(job, 5));
  const std::string scan = client::job_report(target(), job)->scan;
  start();
  const client::JobReport report = end_of(job);
  ASSERT_EQ(report.state, "finished") << report.message;
  EXPECT_EQ(report.scan, scan);
  const auto interrupted = hashes(get("scans/" + scan + "/report.json"));
  EXPECT_EQ(get("scans")["scans"].size(), 1u);
  const client::JobReport undisturbed = end_of(send(path));
  EXPECT_EQ(interrupted, hashes(get("scans/" + undisturbed.scan + "/report.json")));
}

}  // namespace
}  // namespace hermite::server
