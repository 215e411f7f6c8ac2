// An export is asked for and taken, from a real server.
#include "server/client/download.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/output/ply.h"
#include "core/output/ply_reader.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/support/plane_cloud.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::client {
namespace {

using testing::HasSubstr;

class DownloadTest : public testing::Test {
 protected:
  DownloadTest() {
    std::filesystem::create_directories(folder_ / "data/scans/" + id_);
    std::ofstream(folder_ / "data/scans/" + id_ + "/cloud.ply", std::ios::binary)
        << output::format_ply(test::plane_cloud(30));
    {
      server::Store store(folder_ / "data/hermite.db");
      server::ScanRow row;
      row.id = id_;
      row.phase = server::ScanPhase::kFinished;
      row.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
      row.finished_at_ms = 1;
      EXPECT_TRUE(store.scans.add(row).ok());
    }
    server_ = std::make_unique<test::RunningServer>(test::test_options(folder_ / "data"));
  }
  DownloadTarget target(const std::string& format) const {
    DownloadTarget target;
    target.server = {"127.0.0.1", static_cast<std::uint16_t>(server_->port()), server_->token(),
                     false};
    target.scan_id = id_;
    target.format = format;
    target.patience = std::chrono::milliseconds(0);
    return target;
  }
  std::string content() const {
    std::ifstream file(out_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  const test::TemporaryFolder folder_;
  const std::string id_ = server::new_scan_id(), out_ = folder_ / "out.ply";
  std::unique_ptr<test::RunningServer> server_;
};

TEST_F(DownloadTest, WhatIsNotThereIsMadeAndComesInPieces) {
  DownloadTarget pieces = target("ply");
  pieces.piece_bytes = 10'000;
  int piece_count = 0;
  DownloadObserver observer;
  observer.on_progress = [&piece_count](std::uint64_t, std::uint64_t) { ++piece_count; };
  const Status done = download(pieces, out_, observer);
  ASSERT_TRUE(done.ok()) << done.error().message;
  EXPECT_GT(piece_count, 2);
  const std::string in_pieces = content();
  EXPECT_GT(output::parse_ply(in_pieces)->triangles.size(), 100u);
  EXPECT_FALSE(std::filesystem::exists(out_ + ".partial"));
  ASSERT_TRUE(download(target("ply"), out_, {}).ok());
  EXPECT_EQ(content(), in_pieces);
}

TEST_F(DownloadTest, ListsWhatThereIs) {
  const Result<std::vector<ExportReport>> reports = export_reports(target(""));
  ASSERT_TRUE(reports.ok());
  const auto cloud = std::find_if(reports->begin(), reports->end(),
                                  [](const ExportReport& one) { return one.format == "cloud"; });
  ASSERT_NE(cloud, reports->end());
  EXPECT_EQ(cloud->state, "ready");
  EXPECT_EQ(cloud->size_bytes, output::format_ply(test::plane_cloud(30)).size());
}

TEST_F(DownloadTest, WhatFailsIsSaidAndLeavesNothing) {
  EXPECT_THAT(download(target("fbx"), out_, {}).error().message,
              HasSubstr("there is no format 'fbx'"));
  std::ofstream(folder_ / "data/scans/" + id_ + "/cloud.ply") << "ply points";
  EXPECT_THAT(download(target("ply"), out_, {}).error().message,
              HasSubstr("ply was not made: cloud.ply"));
  DownloadTarget nobody = target("ply");
  nobody.server.token = "wrong";
  EXPECT_EQ(download(nobody, out_, {}).error().code, ErrorCode::kUnauthorized);
  EXPECT_EQ(download(target("cloud"), folder_ / "none/out.ply", {}).error().code, ErrorCode::kIo);
  DownloadTarget other = target("ply");
  other.scan_id = server::new_scan_id();
  EXPECT_EQ(download(other, out_, {}).error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(std::filesystem::exists(out_));
  EXPECT_FALSE(std::filesystem::exists(out_ + ".partial"));
}

TEST_F(DownloadTest, WhoGivesUpHasNothing) {
  DownloadObserver observer;
  observer.interrupted = [] { return true; };
  EXPECT_THAT(download(target("ply"), out_, observer).error().message, HasSubstr("interrupted"));
  EXPECT_FALSE(std::filesystem::exists(out_));
}

}  // namespace
}  // namespace hermite::client
