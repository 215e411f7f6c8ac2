// What tokens and share links allow on a WebSocket, and what the quotas say. On a real server;
// scans that run need a GPU.
#include "server/connections/sessions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/digest/sha256.h"
#include "core/pipeline/doctor.h"
#include "server/store/scan_id.h"
#include "server/store/secret.h"
#include "server/store/store.h"
#include "server/store/unix_time.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using test::RawClient;
using testing::HasSubstr;

class SessionsTest : public testing::Test {
 protected:
  // Tokens "view" and "scan", named after what they allow, and the link "share" of the finished
  // scan id_.
  SessionsTest() {
    std::filesystem::create_directories(folder_ / "data");
    Store store(folder_ / "data/hermite.db");
    for (const std::string& id : {id_, other_id_}) {
      ScanRow scan;
      scan.id = id;
      scan.phase = ScanPhase::kFinished;
      scan.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
      EXPECT_TRUE(store.scans.add(scan).ok());
    }
    add(store, "view", {true, false, false}, "");
    add(store, "scan", {false, true, false}, "");
    add(store, "share", {true, false, false}, id_);
  }

  static void add(Store& store, const std::string& secret, const Scopes& scopes,
                  const std::string& scan_id) {
    TokenRow row;
    row.id = "id of " + secret;
    row.secret_sha256 = digest::sha256(secret);
    row.scopes = scopes;
    row.scan_id = scan_id;
    EXPECT_TRUE(store.tokens.add(row).ok());
  }

  void serve(int scans_per_token = 2, int storage_gb = 0) {
    ServiceOptions options = test::test_options(folder_ / "data");
    options.scans_per_token = scans_per_token;
    options.storage_gb = storage_gb;
    server_ = std::make_unique<test::RunningServer>(options);
  }

  static wire::StartScan camera() {
    wire::StartScan start;
    start.title = "t";
    start.camera = {160, 120, 131, 131, 79.5, 59.5, 5000};
    start.depth_codecs = {wire::DepthCodec::kRvlZstd};
    start.color_codecs = {wire::ColorCodec::kJpeg};
    return start;
  }

  // What a hello brings: a welcome, or a message and a close code.
  struct Outcome {
    std::unique_ptr<RawClient> client;
    std::string scan_id;  // welcome
    std::string message;  // refused
    int close_code = 0;
  };
  Outcome hello(const std::string& token,
                const std::variant<wire::StartScan, wire::ViewScan>& role) {
    Outcome outcome{std::make_unique<RawClient>(server_->port()), {}, {}, 0};
    EXPECT_TRUE(outcome.client->upgrade());
    std::visit(
        [&](const auto& body) {
          outcome.client->send_message(wire::Hello{0, "test", token, body});
        },
        role);
    const std::optional<wire::ServerMessage> first = outcome.client->read_message();
    if (first && std::holds_alternative<wire::Welcome>(*first))
      outcome.scan_id = std::get<wire::Welcome>(*first).scan_id;
    if (first && std::holds_alternative<wire::ErrorMessage>(*first)) {
      outcome.message = std::get<wire::ErrorMessage>(*first).message;
      outcome.close_code = outcome.client->close_code();
    }
    return outcome;
  }

  std::string revoke(const std::string& kind, const std::string& id) {
    RawClient client(server_->port());
    client.send("DELETE /api/v1/" + kind + "/" + id +
                " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nAuthorization: Bearer " +
                server_->token() + "\r\n\r\n");
    return client.read_header();
  }

  static bool gpu_is_fit() {
    static const bool fit = pipeline::examine_device("").problems.empty();
    return fit;
  }

  const test::TemporaryFolder folder_;
  const std::string id_ = new_scan_id(), other_id_ = new_scan_id();
  std::unique_ptr<test::RunningServer> server_;
};

TEST_F(SessionsTest, AViewersTokenMayNotScan) {
  serve();
  const Outcome camera_with_view = hello("view", camera());
  EXPECT_EQ(camera_with_view.message, "this token allows view; scan is needed");
  EXPECT_EQ(camera_with_view.close_code, 4003);
  EXPECT_EQ(hello("view", wire::ViewScan{id_}).scan_id, id_);
}

TEST_F(SessionsTest, ACamerasTokenMayNotLook) {
  serve();
  const Outcome viewer_with_scan = hello("scan", wire::ViewScan{id_});
  EXPECT_EQ(viewer_with_scan.message, "this token allows scan; view is needed");
  EXPECT_EQ(viewer_with_scan.close_code, 4003);
}

TEST_F(SessionsTest, AShareLinkShowsItsScanOnly) {
  serve();
  EXPECT_EQ(hello("share", wire::ViewScan{id_}).scan_id, id_);
  for (const std::string& id : {other_id_, new_scan_id()}) {
    const Outcome other = hello("share", wire::ViewScan{id});
    EXPECT_EQ(other.message, "there is no scan " + id)
        << "the same words whether there is one or not";
    EXPECT_EQ(other.close_code, 4004);
  }
  EXPECT_EQ(hello("share", camera()).close_code, 4003);
}

TEST_F(SessionsTest, TooManyWrongTokensMustWait) {
  serve();
  for (int i = 0; i < ServiceOptions().failures_per_minute; ++i)
    EXPECT_EQ(hello("wrong", wire::ViewScan{id_}).close_code, 4001);
  const Outcome late = hello("wrong", wire::ViewScan{id_});
  EXPECT_THAT(late.message, HasSubstr("try again in"));
  EXPECT_EQ(late.close_code, 4013);
  EXPECT_EQ(hello("view", wire::ViewScan{id_}).scan_id, id_);
}

TEST_F(SessionsTest, ARevocationEndsWhatWasOpenedWithTheToken) {
  if (!gpu_is_fit()) GTEST_SKIP() << "no fit GPU here";
  serve();
  Outcome watched = hello(server_->token(), camera());
  ASSERT_NE(watched.scan_id, "");
  Outcome viewer = hello("view", wire::ViewScan{watched.scan_id});
  ASSERT_EQ(viewer.scan_id, watched.scan_id);
  ASSERT_THAT(revoke("tokens", "id%20of%20view"), HasSubstr(" 404 ")) << "paths are not decoded";
  ASSERT_THAT(revoke("tokens", kFirstTokenId), HasSubstr(" 200 "));
  const auto error = watched.client->read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_THAT(error->message, HasSubstr("expired or was revoked"));
  EXPECT_EQ(watched.client->close_code(), 4001);
  EXPECT_EQ(viewer.client->close_code(), 1000)
      << "the scan was interrupted; its viewer's token still holds";
}

TEST_F(SessionsTest, AnExpiryEndsWhatWasOpenedWithTheToken) {
  if (!gpu_is_fit()) GTEST_SKIP() << "no fit GPU here";
  {
    Store store(folder_ / "data/hermite.db");
    TokenRow soon;
    soon.id = "soon";
    soon.secret_sha256 = digest::sha256("soon");
    soon.scopes.view = true;
    soon.expires_at_ms = unix_now_ms() + 3000;
    ASSERT_TRUE(store.tokens.add(soon).ok());
  }
  serve();
  Outcome watched = hello(server_->token(), camera());
  Outcome viewer = hello("soon", wire::ViewScan{watched.scan_id});
  ASSERT_EQ(viewer.scan_id, watched.scan_id);
  EXPECT_EQ(viewer.client->close_code(), 4001);
}

TEST_F(SessionsTest, ATokenRunsSoManyScansAtOnce) {
  if (!gpu_is_fit()) GTEST_SKIP() << "no fit GPU here";
  serve(1);
  const Outcome first = hello("scan", camera());
  ASSERT_NE(first.scan_id, "");
  const Outcome second = hello("scan", camera());
  EXPECT_THAT(second.message, HasSubstr("this token may have at most 1 scans that run at once"));
  EXPECT_EQ(second.close_code, 4013);
  EXPECT_NE(hello(server_->token(), camera()).scan_id, "")
      << "an administrator's may run as many as the server";
}

TEST_F(SessionsTest, NoScanBeginsWhenTheStorageIsUsedUp) {
  const std::string folder = folder_ / "data/scans/" + id_;
  std::filesystem::create_directories(folder);
  { std::ofstream(folder + "/cloud.ply") << "x"; }
  std::filesystem::resize_file(folder + "/cloud.ply", 1'000'000'000);  // sparse
  serve(2, 1);
  const Outcome refused = hello(server_->token(), camera());
  EXPECT_THAT(refused.message, HasSubstr("take 1000 MB of the 1000 MB"));
  EXPECT_THAT(refused.message, HasSubstr("delete some"));
  EXPECT_EQ(refused.close_code, 4013);
}

TEST_F(SessionsTest, NoScanBeginsOnADiskWithoutRoomForItsResults) {
  ServiceOptions options = test::test_options(folder_ / "data");
  options.min_free_disk_mb = 1'000'000'000;
  server_ = std::make_unique<test::RunningServer>(options);
  const Outcome refused = hello(server_->token(), camera());
  EXPECT_THAT(refused.message, HasSubstr("the server's disk has not enough room"));
  EXPECT_EQ(refused.close_code, 4013);
}

}  // namespace
}  // namespace hermite::server
