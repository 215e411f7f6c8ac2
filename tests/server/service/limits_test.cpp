// Walks over the table of limits: whoever takes all that one token may have keeps nobody else from
// being served.
#include "server/service/limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/digest/sha256.h"
#include "server/access/places.h"
#include "server/disk/storage_quota.h"
#include "server/exports/exports.h"
#include "server/scan/subscribers.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/source_root/source_root.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using test::RawClient;
using testing::HasSubstr;

// A server with three tokens; whoever it is, `take` asks for one more of something and says whether
// it was given.
class SharesTest : public testing::TestWithParam<Shared> {
 protected:
  enum class Who { kGreedy, kOther, kAdmin };

  SharesTest() {
    std::filesystem::create_directories(folder_ / "data");
    {
      Store store(folder_ / "data/hermite.db");
      ScanRow scan;
      scan.id = scan_id_;
      scan.phase = ScanPhase::kFinished;
      scan.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
      EXPECT_TRUE(store.scans.add(scan).ok());
      for (const char* name : {"greedy", "other"}) {
        TokenRow row;
        row.id = name;
        row.secret_sha256 = digest::sha256(name);
        row.scopes = {true, true, false};
        EXPECT_TRUE(store.tokens.add(row).ok());
      }
    }
    options_ = test::test_options(folder_ / "data");
    options_.max_connections = 64;
    options_.connections_per_token = 4;
    options_.max_scans = 8;
    // Only where it is looked at: the walk over the other limits is quicker than a person.
    if (GetParam() == Shared::kRequests) options_.requests_per_second = 2;
    // Every request comes from an address of its own, by what a proxy says: this is about tokens.
    options_.trusted_proxies = {"127.0.0.1"};
    options_.uploads_per_token_gb = 1;
    options_.max_upload_gb = 1;
    server_ = std::make_unique<test::RunningServer>(options_);
  }

  static std::string token_id(Who who) {
    return who == Who::kGreedy ? "greedy" : who == Who::kOther ? "other" : kFirstTokenId;
  }
  std::string secret(Who who) const {
    return who == Who::kAdmin ? server_->token() : token_id(who);
  }

  int ask(Who who, const std::string& method, const std::string& path,
          const std::string& headers = "", const std::string& body = "") {
    ++asked_;
    RawClient client(server_->port());
    client.send(method + " " + path +
                " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nAuthorization: Bearer " +
                secret(who) + "\r\nX-Forwarded-For: 10.0." + std::to_string(asked_ / 250) + "." +
                std::to_string(asked_ % 250) + "\r\n" + headers +
                (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") +
                "\r\n" + body);
    const std::string answer = client.read_to_end();
    return answer.size() < 12 ? 0 : std::stoi(answer.substr(9, 3));
  }
  bool view(Who who) {
    auto client = std::make_unique<RawClient>(server_->port());
    client->upgrade();
    client->send_message(wire::Hello{0, "test", secret(who), wire::ViewScan{scan_id_}});
    const std::optional<wire::ServerMessage> first = client->read_message();
    const bool welcome = first && std::holds_alternative<wire::Welcome>(*first);
    open_.push_back(std::move(client));
    return welcome;
  }
  bool run(Who who) {
    const PlaceRequest request{token_id(who), who == Who::kAdmin, false};
    const bool taken = places_.check(request).ok();
    if (taken) places_.began(new_scan_id(), request);
    return taken;
  }
  bool wait(Who who) {
    return places_
        .wait(
            {token_id(who), who == Who::kAdmin, false}, [](const wire::Waiting&) {}, [] {})
        .ok();
  }
  bool watch(Who who) {
    auto viewer = Subscribers::join(subscribers_, {token_id(who), who == Who::kAdmin}, {}, [] {});
    if (viewer.ok()) viewers_.push_back(*std::move(viewer));
    return viewer.ok();
  }
  bool store(Who who) {
    std::vector<std::string> own;
    for (const auto& [id, bytes] : stored_)
      if (id.starts_with(token_id(who))) own.push_back(id);
    const StorageQuota quota(10'000'000'000, [this] { return stored_; }, {});
    const bool taken = quota.check(0, 1'000'000'000, {who == Who::kAdmin, own, 0}).ok();
    if (taken) stored_[token_id(who) + std::to_string(stored_.size())] = 1'000'000'000;
    return taken;
  }

  bool take(Shared which, Who who) {
    const std::string tus = "Tus-Resumable: 1.0.0\r\n";
    switch (which) {
      case Shared::kTokens: return ask(who, "POST", "/api/v1/tokens") == 201;
      case Shared::kShareLinks:
        return ask(who, "POST", "/api/v1/scans/" + scan_id_ + "/shares") == 201;
      case Shared::kUploads:
        return ask(who, "POST", "/api/v1/uploads", tus + "Upload-Length: 1\r\n") == 201;
      case Shared::kUploadBytes:
        return ask(who, "POST", "/api/v1/uploads", tus + "Upload-Length: 100000000\r\n") == 201;
      case Shared::kJobs: return add_job(who);
      case Shared::kRunningScans: return run(who);
      case Shared::kWaitingCameras: return wait(who);
      case Shared::kStorage: return store(who);
      case Shared::kViewers: return watch(who);
      case Shared::kConnections: return view(who);
      case Shared::kRequests: return ask(who, "GET", "/api/v1/scans") == 200;
      case Shared::kExports: return add_export(who);
    }
    return false;
  }
  // With threads that do nothing: what is asked for stays where it is.
  bool add_export(Who who) {
    if (!exports_) {
      const auto never = [](std::function<void()>) {};
      exports_ = std::make_unique<Exports>(
          blobs_, Exports::Hooks{never,
                                 never,
                                 [](const std::string& id) {
                                   ScanRow row;
                                   row.id = id;
                                   row.phase = ScanPhase::kFinished;
                                   return Result<ScanRow>(row);
                                 },
                                 {},
                                 [](std::uint64_t) { return Status(Done{}); },
                                 [] {},
                                 [](const std::string&) {}});
    }
    const std::string scan = new_scan_id();
    EXPECT_TRUE(blobs_.put(scan, "cloud.ply", "points").ok());
    return exports_->request({scan, std::string(kViewerMesh), token_id(who), who == Who::kAdmin})
        .ok();
  }
  // In a store of its own: on the server jobs end as soon as they begin.
  bool add_job(Who who) {
    if (!jobs_) {
      jobs_ = std::make_unique<Store>(folder_ / "jobs.db");
      TokenRow admin;
      admin.id = kFirstTokenId;
      admin.secret_sha256 = digest::sha256("a");
      admin.scopes = {true, true, true};
      EXPECT_TRUE(jobs_->tokens.add(admin).ok());
    }
    JobRow row;
    row.id = new_scan_id();
    row.token_id = token_id(who);
    return jobs_->jobs.add(row).ok();
  }

  const test::TemporaryFolder folder_;
  const std::string scan_id_ = new_scan_id();
  ServiceOptions options_;
  std::unique_ptr<test::RunningServer> server_;
  int asked_ = 0;
  std::vector<std::unique_ptr<RawClient>> open_;
  Places places_{{8, 2, 0, 0}};
  const std::shared_ptr<Subscribers> subscribers_ = std::make_shared<Subscribers>(SceneInfo{});
  std::vector<std::unique_ptr<Viewer>> viewers_;
  StorageQuota::Sizes stored_;
  std::unique_ptr<Store> jobs_;
  FileBlobs blobs_{folder_.path()};
  std::unique_ptr<Exports> exports_;
};

TEST_P(SharesTest, WhoTakesAllThatOneTokenMayHaveKeepsNobodyElseFromIt) {
  const std::vector<SharedLimit> limits = shared_limits(options_);
  const auto limit = std::find_if(limits.begin(), limits.end(),
                                  [](const SharedLimit& row) { return row.which == GetParam(); });
  ASSERT_NE(limit, limits.end());
  constexpr int kFarTooMany = 250;
  int taken = 0;
  while (taken < kFarTooMany && take(GetParam(), Who::kGreedy)) ++taken;
  EXPECT_LT(taken, kFarTooMany) << "there is no limit for one token";
  const bool for_admins_only = limit->share.per_token == 0 && limit->share.for_admins > 0;
  if (limit->unit.empty() && GetParam() != Shared::kRequests) {
    EXPECT_EQ(taken, limit->share.per_token);
  }
  if (!for_admins_only) {
    EXPECT_GT(taken, 0);
    EXPECT_TRUE(take(GetParam(), Who::kOther)) << "another token is not served";
  }
  EXPECT_TRUE(take(GetParam(), Who::kAdmin)) << "an administrator is not served";
}

INSTANTIATE_TEST_SUITE_P(OfTheTable, SharesTest, testing::ValuesIn(kAllShared));

TEST(Limits, AreInSecurityMdAsTheyAreHere) {
  std::ifstream file(test::source_root() / "server/SECURITY.md");
  const std::string document{std::istreambuf_iterator<char>(file),
                             std::istreambuf_iterator<char>()};
  EXPECT_THAT(document, HasSubstr(limits_text(ServiceOptions())));
}

TEST(Shares, AdministratorsAreHeldToTheLimitForAllAlone) {
  constexpr Share share{10, 3, 2};
  EXPECT_TRUE(check_share(share, {7, 2}, false, "x").ok());
  EXPECT_THAT(check_share(share, {7, 3}, false, "x").error().message,
              HasSubstr("this token may have at most 3 x"));
  EXPECT_THAT(check_share(share, {8, 0}, false, "x").error().message, HasSubstr("at most 8 x"));
  EXPECT_TRUE(check_share(share, {9, 9}, true, "x").ok());
  EXPECT_EQ(check_share(share, {10, 0}, true, "x").error().code, ErrorCode::kBusy);
  EXPECT_FALSE(check_share(share, {9, 0}, true, "x", 2).ok());
}

}  // namespace
}  // namespace hermite::server
