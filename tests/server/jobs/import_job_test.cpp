// Clouds and meshes that become scans: a real server and real uploads. tests/server/import_test.py
// does it with the programs.
#include "server/jobs/import_job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/output/ply.h"
#include "server/client/api_request.h"
#include "server/client/upload.h"
#include "tests/support/plane_cloud.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

class ImportJobTest : public testing::Test {
 protected:
  explicit ImportJobTest() {
    ServiceOptions options = test::test_options(folder_ / "data");
    options.drain_s = 0;
    server_ = std::make_unique<test::RunningServer>(options);
  }
  client::UploadTarget target() const {
    client::UploadTarget target;
    target.server = {"127.0.0.1", static_cast<std::uint16_t>(server_->port()), server_->token(),
                     false};
    return target;
  }
  client::JobReport import(const std::string& bytes, const client::UploadMetadata& metadata) {
    std::ofstream(folder_ / "file", std::ios::binary) << bytes;
    const Result<std::string> job =
        client::upload(*client::open_bytes(folder_ / "file"), metadata, target(), {});
    EXPECT_TRUE(job.ok()) << (job.ok() ? "" : job.error().message);
    return *client::wait_for_job(target(), *job, [](const client::JobReport&) { return true; });
  }
  std::size_t entries(const std::string& name) {
    const std::filesystem::directory_iterator all(folder_ / ("data/" + name));
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
  }

  const test::TemporaryFolder folder_;
  std::unique_ptr<test::RunningServer> server_;
};

TEST_F(ImportJobTest, ACloudIsAFinishedScan) {
  const client::JobReport report =
      import(output::format_ply(test::plane_cloud(20)), {{"filename", "wall.ply"}});
  ASSERT_EQ(report.state, "finished") << report.message;
  EXPECT_EQ(report.title, "wall");
  EXPECT_THAT(report.message, HasSubstr("points"));
  EXPECT_EQ(entries("uploads"), 0u) << "what was used up goes";
  const std::string scan =
      *client::api_request(target().server, "GET", "/api/v1/scans/" + report.scan, "");
  EXPECT_THAT(scan, testing::AllOf(HasSubstr("\"state\":\"finished\""),
                                   HasSubstr("\"title\":\"wall\""), HasSubstr("\"width\":0")));
}

TEST_F(ImportJobTest, WhatIsWrongFailsTheJobAndLeavesNothing) {
  std::string cut = output::format_ply(test::plane_cloud(20));
  cut.resize(cut.size() / 2);
  const client::JobReport report = import(cut, {{"filename", "wall.ply"}});
  EXPECT_EQ(report.state, "failed");
  EXPECT_THAT(report.message, HasSubstr("PLY: cut at vertex"));
  EXPECT_EQ(entries("scans"), 0u);
  const client::JobReport setting = import(output::format_ply(test::plane_cloud(5)),
                                           {{"settings", R"({"map.stable_confidence": "1"})"}});
  EXPECT_EQ(setting.state, "failed");
  EXPECT_THAT(setting.message, HasSubstr("'map.stable_confidence' is not an import setting"));
}

}  // namespace
}  // namespace hermite::server
