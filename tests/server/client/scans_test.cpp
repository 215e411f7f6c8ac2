// Scans are listed, renamed, stopped, deleted and shared through a real server.
#include "server/client/scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "tests/support/listed_scans.h"

namespace hermite::client::scans_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class ScansOfAServer : public test::ListedScans {
 protected:
  // The scans' titles are the numbers from 0 on.
  void serve(int scan_count) {
    serve_rows(scan_count, [](server::ScanRow& row, int i) {
      row.title = std::to_string(i);
      row.phase = i % 2 == 0 ? server::ScanPhase::kFinished : server::ScanPhase::kInterrupted;
      row.message = i % 2 == 0 ? "" : "the camera has gone";
      row.frames_received = 12;
      row.frames_processed = 10;
      row.frames_dropped = 2;
    });
  }
};

TEST_F(ScansOfAServer, AreListedNewestFirstAndShown) {
  serve(3);
  const Result<std::vector<ScanSummary>> scans = list_scans(target_, 2);
  ASSERT_TRUE(scans.ok()) << scans.error().message;
  ASSERT_EQ(scans->size(), 2u);
  EXPECT_EQ((*scans)[0].title, "2");
  EXPECT_EQ((*scans)[1].id, ids_[1]);
  const Result<ScanSummary> scan = show_scan(target_, ids_[1]);
  ASSERT_TRUE(scan.ok()) << scan.error().message;
  EXPECT_EQ(scan->state, "interrupted");
  EXPECT_EQ(scan->message, "the camera has gone");
  EXPECT_THAT(scan->created_at, StartsWith("2024-05-01T12:00:00"));
  EXPECT_THAT(scan->finished_at, StartsWith("2024-05-01T12:01:00"));
  EXPECT_EQ(scan->frames_received, 12);
  EXPECT_EQ(scan->frames_processed, 10);
  EXPECT_EQ(scan->frames_dropped, 2);
  EXPECT_EQ(scan->width_px, 640);
  EXPECT_EQ(scan->height_px, 480);
  EXPECT_THAT(scan->json, HasSubstr("\"id\":\"" + ids_[1] + "\""));
}

// The server lists at most a thousand at once.
TEST_F(ScansOfAServer, AreAllListedWhereTheyTakeSeveralAnswers) {
  serve(2001);
  const Result<std::vector<ScanSummary>> scans = list_scans(target_, 5000);
  ASSERT_TRUE(scans.ok()) << scans.error().message;
  ASSERT_EQ(scans->size(), 2001u);
  for (std::size_t i = 0; i < scans->size(); ++i)
    ASSERT_EQ((*scans)[i].title, std::to_string(2000 - i));
}

TEST_F(ScansOfAServer, AreRenamedAndDeleted) {
  serve(1);
  const Result<ScanSummary> renamed = rename_scan(target_, ids_[0], "A \"kitchen\", ü");
  ASSERT_TRUE(renamed.ok()) << renamed.error().message;
  EXPECT_EQ(show_scan(target_, ids_[0])->title, "A \"kitchen\", ü");
  EXPECT_EQ(tag_scan(target_, ids_[0], {"old", "house 9"})->tags,
            (std::vector<std::string>{"house 9", "old"}));
  EXPECT_THAT(tag_scan(target_, ids_[0], {std::string(51, 'x')}).error().message,
              HasSubstr("tags[0]"));
  EXPECT_EQ(show_scan(target_, ids_[0])->tags.size(), 2u);
  const Result<ScanSummary> unnamed = rename_scan(target_, ids_[0], "");
  ASSERT_FALSE(unnamed.ok());
  EXPECT_EQ(unnamed.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(unnamed.error().message, HasSubstr("title"));
  EXPECT_EQ(stop_scan(target_, ids_[0]).error().code, ErrorCode::kBusy) << "it has ended";
  EXPECT_TRUE(delete_scan(target_, ids_[0]).ok());
  EXPECT_EQ(delete_scan(target_, ids_[0]).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(list_scans(target_, 10)->empty());
}

TEST_F(ScansOfAServer, AreSharedByALinkThatCanBeRevoked) {
  serve(2);
  const Result<std::string> link = share_scan(target_, ids_[0], "The architect", 30);
  ASSERT_TRUE(link.ok()) << link.error().message;
  EXPECT_THAT(*link, StartsWith("http://" + target_.server.host_and_port() + "/#"));
  ASSERT_TRUE(share_scan(target_, ids_[1], "", 0).ok());
  EXPECT_EQ(list_shares(target_, "")->size(), 2u);
  const Result<std::vector<ShareSummary>> shares = list_shares(target_, ids_[0]);
  ASSERT_EQ(shares->size(), 1u);
  const ShareSummary& share = shares->front();
  EXPECT_EQ(share.scan, ids_[0]);
  EXPECT_EQ(share.name, "The architect");
  EXPECT_EQ(share.state, "active");
  EXPECT_TRUE(revoke_share(target_, share.id).ok());
  EXPECT_EQ(list_shares(target_, ids_[0])->front().state, "revoked");
  EXPECT_EQ(share_scan(target_, server::new_scan_id(), "", 0).error().code, ErrorCode::kNotFound);
}

TEST_F(ScansOfAServer, AreForNobodyWithoutAToken) {
  serve(1);
  target_.server.token = "wrong";
  EXPECT_EQ(list_scans(target_, 10).error().code, ErrorCode::kUnauthorized);
  EXPECT_EQ(delete_scan(target_, ids_[0]).error().code, ErrorCode::kUnauthorized);
}

}  // namespace
}  // namespace hermite::client::scans_test
