#include "server/access/gate.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>

#include "core/digest/sha256.h"
#include "server/store/secret.h"
#include "server/store/store.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kPresent_ms = 1'700'000'000'000;
constexpr int kFailures = 5;

class GateTest : public testing::Test {
 protected:
  std::string add(const std::string& id, const Scopes& scopes, std::int64_t expires_at_ms = 0) {
    const std::string secret = new_secret(kTokenPrefix);
    TokenRow row;
    row.id = id;
    row.secret_sha256 = digest::sha256(secret);
    row.scopes = scopes;
    row.created_at_ms = kPresent_ms;
    row.expires_at_ms = expires_at_ms;
    EXPECT_TRUE(store_.tokens.add(row).ok());
    return secret;
  }
  Result<Grant> admit(const std::string& secret, std::int64_t now_ms = kPresent_ms,
                      const std::string& address = "1.2.3.4") {
    return gate_.admit(secret, {address, now_ms});
  }

  const test::TemporaryFolder folder_;
  Store store_{folder_ / "db"};
  Gate gate_{store_, kFailures};
};

TEST_F(GateTest, ASecretGetsWhatItsRowAllows) {
  const std::string secret = add("t", {true, false, false});
  const Result<Grant> grant = admit(secret);
  ASSERT_TRUE(grant.ok()) << grant.error().message;
  EXPECT_EQ(grant->token_id, "t");
  EXPECT_TRUE(may(*grant, Scope::kView));
  EXPECT_FALSE(may(*grant, Scope::kScan));
  EXPECT_FALSE(may(*grant, Scope::kAdmin));
  EXPECT_TRUE(may_see(*grant, "any scan"));
}

TEST_F(GateTest, AdminIncludesTheOthers) {
  const Result<Grant> grant = admit(add("t", {false, false, true}));
  for (const Scope scope : kAllScopes) EXPECT_TRUE(may(*grant, scope));
}

TEST_F(GateTest, AWordAboutWhatIsMissing) {
  EXPECT_EQ(lacks(*admit(add("t", {true, true, false})), Scope::kAdmin).message,
            "this token allows view, scan; admin is needed");
}

TEST_F(GateTest, OtherSecretsAreNothing) {
  const std::string secret = add("t", {true, true, true});
  for (const std::string& wrong :
       {std::string(), std::string("t"), secret + "0", secret.substr(1), digest::sha256(secret)})
    EXPECT_EQ(admit(wrong).error().code, ErrorCode::kUnauthorized);
}

TEST_F(GateTest, ATokenExpires) {
  const std::string secret = add("t", {true, false, false}, kPresent_ms + 1000);
  const Result<Grant> grant = admit(secret, kPresent_ms + 999);
  ASSERT_TRUE(grant.ok());
  EXPECT_TRUE(gate_.holds(*grant, kPresent_ms + 999));
  EXPECT_FALSE(gate_.holds(*grant, kPresent_ms + 1000)) << "what was opened before ends too";
  EXPECT_EQ(admit(secret, kPresent_ms + 1000).error().code, ErrorCode::kUnauthorized);
}

TEST_F(GateTest, ARevokedTokenIsWorthNothingAndWhatWasGrantedEnds) {
  const std::string secret = add("t", {true, false, false});
  const Result<Grant> grant = admit(secret), other = admit(add("o", {true, false, false}));
  ASSERT_TRUE(store_.tokens.revoke("t", kPresent_ms).ok());
  gate_.forget_grants("t");
  EXPECT_FALSE(gate_.holds(*grant, kPresent_ms));
  EXPECT_TRUE(gate_.holds(*other, kPresent_ms));
  EXPECT_EQ(admit(secret).error().message, admit("unknown").error().message)
      << "or one learns that it once was right";
}

TEST_F(GateTest, AShareLinkOpensOneScan) {
  ScanRow scan;
  scan.id = "scan";
  scan.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
  ASSERT_TRUE(store_.scans.add(scan).ok());
  TokenRow row;
  row.id = "s";
  row.secret_sha256 = digest::sha256("link");
  row.scopes.view = true;
  row.scan_id = "scan";
  ASSERT_TRUE(store_.tokens.add(row).ok());
  const Result<Grant> grant = admit("link");
  ASSERT_TRUE(grant.ok());
  EXPECT_TRUE(may_see(*grant, "scan"));
  EXPECT_FALSE(may_see(*grant, "scan2"));
  EXPECT_FALSE(may_see(*grant, ""));
}

TEST_F(GateTest, TooManyWrongSecretsOfAnAddressMustWait) {
  const std::string secret = add("t", {true, false, false});
  for (int i = 0; i < kFailures; ++i)
    EXPECT_EQ(admit("wrong").error().code, ErrorCode::kUnauthorized);
  const Result<Grant> late = admit("wrong");
  EXPECT_EQ(late.error().code, ErrorCode::kBusy);
  EXPECT_THAT(late.error().message, HasSubstr("try again in 12 s"));
  EXPECT_TRUE(admit(secret).ok()) << "a right one behind the same proxy is not locked out";
  EXPECT_EQ(admit("wrong", kPresent_ms, "5.6.7.8").error().code, ErrorCode::kUnauthorized)
      << "nor are others";
  EXPECT_EQ(admit("wrong", kPresent_ms + gate_.failure_wait_ms()).error().code,
            ErrorCode::kUnauthorized);
}

TEST_F(GateTest, NotesTheLastUseButNotEveryUse) {
  const std::string secret = add("t", {true, false, false});
  ASSERT_TRUE(admit(secret).ok());
  EXPECT_EQ(store_.tokens.find("t")->used_at_ms, kPresent_ms);
  ASSERT_TRUE(admit(secret, kPresent_ms + kLastUsePrecision_ms - 1).ok());
  EXPECT_EQ(store_.tokens.find("t")->used_at_ms, kPresent_ms);
  ASSERT_TRUE(admit(secret, kPresent_ms + kLastUsePrecision_ms).ok());
  EXPECT_EQ(store_.tokens.find("t")->used_at_ms, kPresent_ms + kLastUsePrecision_ms);
}

TEST_F(GateTest, TheFirstTokenIsTheFiles) {
  EXPECT_TRUE(gate_.install_first_token("one", kPresent_ms));
  EXPECT_TRUE(gate_.install_first_token("one", kPresent_ms + 1));
  EXPECT_TRUE(may(*admit("one"), Scope::kAdmin));
  EXPECT_TRUE(gate_.install_first_token("two", kPresent_ms)) << "the file was deleted";
  EXPECT_FALSE(admit("one").ok());
  EXPECT_TRUE(admit("two").ok());
}

TEST_F(GateTest, ARevokedFirstTokenStaysRevokedOverARestart) {
  ASSERT_TRUE(gate_.install_first_token("one", kPresent_ms));
  ASSERT_TRUE(store_.tokens.revoke(kFirstTokenId, kPresent_ms).ok());
  Gate again(store_, kFailures);
  constexpr std::int64_t kYear_ms = 365LL * 24 * 3600 * 1000;
  EXPECT_FALSE(again.install_first_token("one", kPresent_ms + kYear_ms));
  EXPECT_FALSE(again.admit("one", {"a", kPresent_ms + kYear_ms}).ok());
}

TEST_F(GateTest, ABrokenStoreLetsNobodyIn) {
  const std::string secret = add("t", {true, false, false});
  {
    SQLite::Database other(folder_ / "db", SQLite::OPEN_READWRITE);
    other.exec("DROP TABLE tokens");
  }
  EXPECT_EQ(admit(secret).error().code, ErrorCode::kIo);
}

TEST_F(GateTest, NoSecretIsEverLogged) {
  std::ostringstream log;
  const auto logger = spdlog::default_logger();
  const auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(log);
  logger->sinks().push_back(sink);
  const auto level = logger->level();
  logger->set_level(spdlog::level::trace);
  const std::string right = add("t", {true, false, false}),
                    revoked = add("r", {true, false, false});
  ASSERT_TRUE(store_.tokens.revoke("r", kPresent_ms).ok());
  for (const std::string& secret : {right, revoked, std::string("hmt_a wrong one")})
    (void)admit(secret);
  logger->flush();
  logger->sinks().pop_back();
  logger->set_level(level);
  EXPECT_THAT(log.str(), HasSubstr("1.2.3.4"));
  for (const std::string& secret : {right, revoked, std::string("a wrong one")})
    EXPECT_THAT(log.str(), Not(HasSubstr(secret)));
}

}  // namespace
}  // namespace hermite::server
