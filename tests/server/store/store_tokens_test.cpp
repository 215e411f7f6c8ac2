// Tokens and share links in the store.
#include <gtest/gtest.h>

#include "core/digest/sha256.h"
#include "server/store/secret.h"
#include "server/store/store.h"
#include "tests/support/temporary_folder.h"

namespace hermite {
namespace {

class StoreTokensTest : public testing::Test {
 protected:
  static TokenRow token(const std::string& id, std::int64_t created_at_ms = 1) {
    TokenRow row;
    row.id = id;
    row.secret_sha256 = sha256("secret of " + id);
    row.name = "name of " + id;
    row.scopes = {true, true, false};
    row.created_at_ms = created_at_ms;
    return row;
  }
  void add_scan(const std::string& id) {
    ScanRow row;
    row.id = id;
    row.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
    ASSERT_TRUE(store_.add(row).ok());
  }
  static TokenRow share(const std::string& id, const std::string& scan_id) {
    TokenRow row = token(id);
    row.scopes = {true, false, false};
    row.scan_id = scan_id;
    return row;
  }

  const test::TemporaryFolder folder_;
  Store store_{folder_ / "db"};
};

TEST_F(StoreTokensTest, AreFoundByTheirHash) {
  TokenRow row = token("a");
  row.expires_at_ms = 77;
  ASSERT_TRUE(store_.add_token(row).ok());
  const Result<TokenRow> found = store_.find_token(sha256("secret of a"));
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->id, "a");
  EXPECT_EQ(found->name, "name of a");
  EXPECT_EQ(found->scopes, row.scopes);
  EXPECT_EQ(found->scan_id, "");
  EXPECT_EQ(found->expires_at_ms, 77);
  EXPECT_EQ(found->revoked_at_ms, 0);
  EXPECT_EQ(store_.find_token(sha256("secret of b")).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_.find_token("secret of a").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_.find_token("").error().code, ErrorCode::kNotFound);
}

TEST_F(StoreTokensTest, AnIdAndASecretAreThereOnce) {
  ASSERT_TRUE(store_.add_token(token("a")).ok());
  EXPECT_EQ(store_.add_token(token("a")).error().code, ErrorCode::kInvalidArgument);
  TokenRow twin = token("b");
  twin.secret_sha256 = sha256("secret of a");
  EXPECT_EQ(store_.add_token(twin).error().code, ErrorCode::kInvalidArgument);
  TokenRow plain = token("c");
  plain.secret_sha256 = "no hash";
  EXPECT_FALSE(store_.add_token(plain).ok());
}

TEST_F(StoreTokensTest, ARevocationStaysAsItWasFirst) {
  ASSERT_TRUE(store_.add_token(token("a")).ok());
  ASSERT_TRUE(store_.revoke_token("a", 100).ok());
  ASSERT_TRUE(store_.revoke_token("a", 200).ok());
  EXPECT_EQ(store_.token("a")->revoked_at_ms, 100);
  EXPECT_EQ(store_.revoke_token("b", 1).error().code, ErrorCode::kNotFound);
}

TEST_F(StoreTokensTest, KnowTheirLastUse) {
  ASSERT_TRUE(store_.add_token(token("a")).ok());
  EXPECT_EQ(store_.token("a")->used_at_ms, 0);
  ASSERT_TRUE(store_.touch_token("a", 300).ok());
  EXPECT_EQ(store_.token("a")->used_at_ms, 300);
  EXPECT_EQ(store_.touch_token("b", 1).error().code, ErrorCode::kNotFound);
}

TEST_F(StoreTokensTest, AreListedNewestFirst) {
  for (const auto& [id, time] : {std::pair{"b", 2}, std::pair{"c", 3}, std::pair{"a", 1}})
    ASSERT_TRUE(store_.add_token(token(id, time)).ok());
  const auto rows = store_.list_tokens();
  ASSERT_EQ(rows->size(), 3u);
  EXPECT_EQ((*rows)[0].id, "c");
  EXPECT_EQ((*rows)[2].id, "a");
}

TEST_F(StoreTokensTest, AShareLinkIsOfAScanThatIsThereAndGoesWithIt) {
  EXPECT_EQ(store_.add_token(share("s", "none")).error().code, ErrorCode::kNotFound);
  add_scan("scan");
  ASSERT_TRUE(store_.add_token(share("s", "scan")).ok());
  EXPECT_EQ(store_.token("s")->scan_id, "scan");
  ASSERT_TRUE(store_.remove("scan").ok());
  EXPECT_EQ(store_.token("s").error().code, ErrorCode::kNotFound);
}

TEST_F(StoreTokensTest, AShareLinkMayOnlyLook) {
  add_scan("scan");
  TokenRow row = share("s", "scan");
  row.scopes.scan = true;
  EXPECT_EQ(store_.add_token(row).error().code, ErrorCode::kInvalidArgument);
}

TEST_F(StoreTokensTest, ThoseThatEndedLongAgoAreForgotten) {
  for (const char* id : {kFirstTokenId, "revoked", "active"}) ASSERT_TRUE(store_.add_token(token(id)).ok());
  for (const char* id : {kFirstTokenId, "revoked"}) ASSERT_TRUE(store_.revoke_token(id, 100).ok());
  TokenRow expired = token("expired");
  expired.expires_at_ms = 100;
  ASSERT_TRUE(store_.add_token(expired).ok());
  EXPECT_EQ(*store_.forget_tokens(100), 0);
  EXPECT_EQ(*store_.forget_tokens(101), 2);
  EXPECT_TRUE(store_.token(kFirstTokenId).ok()) << "or its file's secret would come to life again";
  EXPECT_TRUE(store_.token("active").ok());
}

}  // namespace
}  // namespace hermite
