#include "server/access/administration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/digest/sha256.h"
#include "server/store/scan_id.h"
#include "server/store/secret.h"
#include "server/store/store.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::int64_t kNow_ms = 1'700'000'000'000;
constexpr std::int64_t kDay_ms = 24LL * 3600 * 1000;

class AdministrationTest : public testing::Test {
 protected:
  AdministrationTest() {
    ScanRow scan;
    scan.id = scan_id_;
    scan.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
    EXPECT_TRUE(store_.scans.add(scan).ok());
  }
  std::string message_of(const std::string& request) {
    const Result<std::string> made = create_token(store_, request, kNow_ms);
    return made.ok()                                          ? "made"
           : made.error().code == ErrorCode::kInvalidArgument ? made.error().message
                                                              : "another code";
  }

  const test::TemporaryFolder folder_;
  const std::string scan_id_ = new_scan_id();
  Store store_{folder_ / "db"};
};

TEST_F(AdministrationTest, ATokensSecretIsShownOnceAndKeptAsAHash) {
  const Json made = Json::parse(
      *create_token(store_, R"({"name": "the lab", "scopes": ["scan"], "days": 2})", kNow_ms));
  const std::string secret = made["secret"];
  EXPECT_THAT(secret, StartsWith(kTokenPrefix));
  const Result<TokenRow> row = store_.tokens.with_secret(digest::sha256(secret));
  ASSERT_TRUE(row.ok());
  EXPECT_EQ(row->id, made["token"]["id"]);
  EXPECT_EQ(row->name, "the lab");
  EXPECT_EQ(row->scopes, (Scopes{false, true, false}));
  EXPECT_EQ(row->expires_at_ms, kNow_ms + 2 * kDay_ms);
  const std::string list = *list_tokens(store_, kNow_ms);
  EXPECT_THAT(list, Not(HasSubstr(secret)));
  EXPECT_THAT(list, Not(HasSubstr(secret.substr(4, 16))));
  EXPECT_THAT(list, HasSubstr("\"state\":\"active\""));
  EXPECT_THAT(*list_tokens(store_, kNow_ms + 2 * kDay_ms), HasSubstr("\"state\":\"expired\""));
}

TEST_F(AdministrationTest, EverythingMayBeMissing) {
  const Json made = Json::parse(*create_token(store_, "", kNow_ms));
  const Result<TokenRow> row =
      store_.tokens.with_secret(digest::sha256(made["secret"].get<std::string>()));
  EXPECT_EQ(row->scopes, (Scopes{true, true, false}));
  EXPECT_EQ(row->expires_at_ms, kNow_ms + kDefaultTokenDays * kDay_ms);
  const Json never = Json::parse(*create_token(store_, R"({"days": 0})", kNow_ms));
  EXPECT_TRUE(never["token"]["expires_at"].is_null());
}

TEST_F(AdministrationTest, WhatIsWrongIsNamed) {
  EXPECT_THAT(message_of("[]"), HasSubstr("no JSON object"));
  EXPECT_THAT(message_of("{"), HasSubstr("no JSON object"));
  EXPECT_THAT(message_of(std::string(4096, '[')), HasSubstr("no JSON object"));
  EXPECT_THAT(message_of(R"({"scope": ["view"]})"), HasSubstr("\"scope\" is not known"));
  EXPECT_THAT(message_of(R"({"name": 3})"), HasSubstr("name"));
  EXPECT_THAT(message_of(R"({"name": ")" + std::string(101, 'x') + R"("})"),
              HasSubstr("allowed are 100"));
  EXPECT_THAT(message_of(R"({"name": "\u001b[2J"})"), HasSubstr("control character"));
  for (const char* scopes : {"[]", "\"view\"", "[\"root\"]", "[1]", "[\"view\", null]", "{}"})
    EXPECT_THAT(message_of(std::string("{\"scopes\": ") + scopes + "}"), HasSubstr("scopes"))
        << scopes;
  for (const char* days : {"-1", "3651", "1.5", "\"7\"", "1e99", "null", "18446744073709551615"})
    EXPECT_THAT(message_of(std::string("{\"days\": ") + days + "}"), HasSubstr("0 to 3650"))
        << days;
  EXPECT_EQ(Json::parse(*list_tokens(store_, kNow_ms))["tokens"].size(), 0u);
}

TEST_F(AdministrationTest, AShareLinkIsOfOneScanAndAlwaysExpires) {
  const Json made = Json::parse(*create_share(store_, scan_id_, "", kNow_ms));
  const std::string secret = made["secret"];
  EXPECT_THAT(secret, StartsWith(kSharePrefix));
  EXPECT_EQ(made["path"], "/#share=" + secret + "&scan=" + scan_id_)
      << "behind the #, which is not sent and not logged";
  const Result<TokenRow> row = store_.tokens.with_secret(digest::sha256(secret));
  EXPECT_EQ(row->scan_id, scan_id_);
  EXPECT_EQ(row->scopes, (Scopes{true, false, false}));
  EXPECT_EQ(row->expires_at_ms, kNow_ms + kDefaultShareDays * kDay_ms);
  for (const char* request : {R"({"days": 0})", R"({"days": 366})", R"({"scopes": ["admin"]})"})
    EXPECT_EQ(create_share(store_, scan_id_, request, kNow_ms).error().code,
              ErrorCode::kInvalidArgument)
        << request;
  for (const std::string& scan_id : {new_scan_id(), std::string(), std::string("../x")})
    EXPECT_EQ(create_share(store_, scan_id, "", kNow_ms).error().code, ErrorCode::kNotFound)
        << scan_id;
}

TEST_F(AdministrationTest, TokensAndShareLinksAreListedApart) {
  ASSERT_TRUE(create_token(store_, "", kNow_ms).ok());
  ASSERT_TRUE(create_share(store_, scan_id_, "", kNow_ms).ok());
  EXPECT_EQ(Json::parse(*list_tokens(store_, kNow_ms))["tokens"].size(), 1u);
  const Json shares = Json::parse(*list_shares(store_, "", kNow_ms))["shares"];
  ASSERT_EQ(shares.size(), 1u);
  EXPECT_EQ(shares[0]["scan"], scan_id_);
  EXPECT_EQ(Json::parse(*list_shares(store_, scan_id_, kNow_ms))["shares"].size(), 1u);
  EXPECT_EQ(Json::parse(*list_shares(store_, new_scan_id(), kNow_ms))["shares"].size(), 0u);
}

TEST_F(AdministrationTest, RevokesWhatIsOfThatKind) {
  const std::string token = Json::parse(*create_token(store_, "", kNow_ms))["token"]["id"];
  const std::string share =
      Json::parse(*create_share(store_, scan_id_, "", kNow_ms))["share"]["id"];
  EXPECT_EQ(revoke_row(store_, token, true, kNow_ms).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(revoke_row(store_, share, false, kNow_ms).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(revoke_row(store_, "none", false, kNow_ms).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(revoke_row(store_, token, false, kNow_ms).ok());
  EXPECT_TRUE(revoke_row(store_, share, true, kNow_ms).ok());
  EXPECT_THAT(*list_tokens(store_, kNow_ms), HasSubstr("\"state\":\"revoked\""));
}

}  // namespace
}  // namespace hermite::server
