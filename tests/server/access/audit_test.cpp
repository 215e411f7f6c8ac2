#include "server/access/audit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class AuditTest : public testing::Test {
 protected:
  static AuditEntry entry(const std::string& did, const std::string& to = "x") {
    return {1'700'000'000'123, "t", "10.0.0.1", did, to, "200"};
  }
  std::vector<Json> entries() {
    std::vector<Json> found;
    const Result<AuditCheck> check =
        check_audit(folder_ / "audit",
                    [&found](const std::string& line) { found.push_back(Json::parse(line)); });
    EXPECT_TRUE(check.ok() && check->broken.empty())
        << (check.ok() ? check->broken : check.error().message);
    return found;
  }
  std::string broken() {
    const Result<AuditCheck> check = check_audit(folder_ / "audit", [](const std::string&) {});
    return check.ok() ? check->broken : check.error().message;
  }
  std::string first_file() const { return folder_ / "audit/audit-000001.jsonl"; }
  std::string text() const {
    std::ifstream file(first_file(), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  void write(const std::string& text) const {
    std::ofstream(first_file(), std::ios::binary) << text;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(AuditTest, EveryEntrySaysWhoDidWhatAndFollowsTheOneBefore) {
  for (int start = 0; start < 2; ++start) {
    Audit audit(folder_ / "audit", 0);
    audit.note(entry("DELETE scan", "a\"b\n\xff"));
    audit.note(entry("POST tokens"));
  }
  const std::vector<Json> all = entries();
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0]["token"], "t");
  EXPECT_EQ(all[0]["address"], "10.0.0.1");
  EXPECT_EQ(all[0]["did"], "DELETE scan");
  EXPECT_EQ(all[0]["at"], "2023-11-14T22:13:20.123Z");
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_EQ(all[i]["n"], i + 1);
    EXPECT_EQ(all[i]["prev"], all[i - 1]["hash"]);
  }
}

TEST_F(AuditTest, WhatIsChangedTakenOutOrPutInShows) {
  {
    Audit audit(folder_ / "audit", 0);
    for (int i = 0; i < 5; ++i) audit.note(entry("PUT " + std::to_string(i)));
  }
  const std::string whole = text();
  EXPECT_EQ(broken(), "");
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < whole.size();) {
    const std::size_t end = whole.find('\n', at) + 1;
    lines.push_back(whole.substr(at, end - at));
    at = end;
  }
  std::string changed = whole;
  changed.replace(changed.find("PUT 2"), 5, "PUT 9");
  write(changed);
  EXPECT_THAT(broken(), HasSubstr("line 3: it was changed"));
  write(lines[0] + lines[1] + lines[3] + lines[4]);
  EXPECT_THAT(broken(), HasSubstr("line 3: it does not follow"));
  write(lines[1] + lines[2]);
  EXPECT_THAT(broken(), HasSubstr("line 1: it does not follow"));
  write(lines[0] + lines[1] + lines[1] + lines[2]);
  EXPECT_THAT(broken(), HasSubstr("line 3: it does not follow"));
  write(lines[0] + "{}\n");
  EXPECT_THAT(broken(), HasSubstr("line 2: it is no entry"));
}

TEST_F(AuditTest, WhatIsCutOffAtTheEndShowsAlsoAfterTheNextStart) {
  std::string whole, head;
  {
    Audit audit(folder_ / "audit", 0);
    for (int i = 0; i < 5; ++i) audit.note(entry("PUT " + std::to_string(i)));
    EXPECT_EQ(broken(), "") << "while it is written";
    audit.tick(0);
    head = audit.head();
  }
  whole = text();
  const std::string shorter = whole.substr(0, whole.find("{\"n\":4"));
  write(shorter);
  EXPECT_THAT(broken(), HasSubstr("2 entries are missing at the end: number 5, " + head));
  {
    Audit audit(folder_ / "audit", 0);
    EXPECT_THAT(audit.missing(), HasSubstr("2 entries are missing"));
    audit.note(entry("PUT 5"));
  }
  EXPECT_THAT(broken(), HasSubstr("before entry 4: 2 entries are missing"));
  std::filesystem::remove(folder_ / "audit/head");
  write(shorter);
  EXPECT_THAT(broken(), HasSubstr("there is no head"));
  { const Audit audit(folder_ / "audit", 0); }
  EXPECT_EQ(check_audit(folder_ / "audit", [](const std::string&) {})->remarks.size(), 1u);
}

TEST_F(AuditTest, AnEndThatWasWrittenAnewShows) {
  {
    Audit audit(folder_ / "audit", 0);
    for (int i = 0; i < 3; ++i) audit.note(entry("PUT " + std::to_string(i)));
  }
  std::filesystem::rename(folder_ / "audit/head", folder_ / "head");
  write(text().substr(0, text().find("{\"n\":3")));
  {
    Audit audit(folder_ / "audit", 0);
    audit.note(entry("GET scan"));
  }
  std::filesystem::rename(folder_ / "head", folder_ / "audit/head");
  EXPECT_THAT(broken(), HasSubstr("entry 3 is another one than"));
}

TEST_F(AuditTest, ALineThatACrashHasCutIsRemoved) {
  {
    Audit audit(folder_ / "audit", 0);
    audit.note(entry("one"));
  }
  write(text() + "{\"n\":2,\"at");
  {
    Audit audit(folder_ / "audit", 0);
    audit.note(entry("two"));
  }
  EXPECT_EQ(entries().size(), 2u);
}

TEST_F(AuditTest, WrongTokensAreCountedByAddressWithoutLoss) {
  constexpr int kAddresses = 30, kEach = 7;
  {
    Audit audit(folder_ / "audit", 0);
    for (int i = 0; i < kAddresses * kEach; ++i)
      audit.wrong_token("10.0.0." + std::to_string(i % kAddresses));
    audit.tick(59'999);
    EXPECT_EQ(audit.entry_count(), 0u);
    audit.tick(60'000);
    EXPECT_EQ(audit.entry_count(), static_cast<std::uint64_t>(kAddresses));
    for (int i = 0; i < 10'000; ++i) audit.wrong_token(std::to_string(i));
  }
  std::int64_t sum = 0;
  for (const Json& one : entries()) {
    EXPECT_EQ(one["did"], "wrong token");
    sum += one["count"].get<std::int64_t>();
  }
  EXPECT_EQ(sum, kAddresses * kEach + 10'000);
  EXPECT_LE(entries().size(), kAddresses + kMaxCounts + 1);
}

// Old entries are removed once there is a gigabyte of newer ones. Whoever could make those has no
// traces.
TEST_F(AuditTest, NobodyWashesItOutByDoingTheSameAgainAndAgain) {
  constexpr std::int64_t kMinutes = 20, kPerSecond = 60;  // as many requests as a token has
  {
    Audit audit(folder_ / "audit", 0);
    audit.note({0, "evil", "10.0.0.9", "DELETE scan", "precious", "200"});
    for (std::int64_t at_ms = 0; at_ms < kMinutes * 60'000; at_ms += 1000 / kPerSecond) {
      audit.note({at_ms, "guest", "10.0.0.9", "GET cloud.ply", std::to_string(at_ms), "200"});
      if (at_ms % 500 == 0) audit.tick(at_ms);
    }
    audit.note({kMinutes * 60'000, "guest", "10.0.0.9", "DELETE scan", "x", "403"});
  }
  const std::vector<Json> all = entries();
  EXPECT_LT(all.size(), kSingleEntries + kMinutes * (kSingleEntriesPerMinute + 1) + 10);
  std::int64_t downloads = 0;
  for (const Json& one : all)
    if (one["did"] == "GET cloud.ply") downloads += one["count"].get<std::int64_t>();
  EXPECT_EQ(downloads, (kMinutes * 60'000 + 1000 / kPerSecond - 1) / (1000 / kPerSecond))
      << "none is lost";
  EXPECT_EQ(all[0]["to"], "precious");
  EXPECT_EQ(all[all.size() - 2]["to"], "x")
      << "another action is an entry of its own at once; the last one are the counts";
}

TEST_F(AuditTest, NobodyWashesItOutWithWrongTokensFromManyAddresses) {
  constexpr std::int64_t kMinutes = 10, kPerMinute = 3600;
  Audit audit(folder_ / "audit", 0);
  for (std::int64_t minute = 0; minute < kMinutes; ++minute) {
    for (std::int64_t i = 0; i < kPerMinute; ++i)
      audit.wrong_token("2001:db8::" + std::to_string(minute * kPerMinute + i));
    audit.tick((minute + 1) * 60'000);
  }
  EXPECT_LE(audit.entry_count(), kMinutes * kCountsPerMinute + kMaxCounts);
}

TEST_F(AuditTest, GoesOnInANewFileAndTheChainHolds) {
  const std::string long_name(100'000, 'x');
  {
    Audit audit(folder_ / "audit", 0);
    for (std::uint64_t i = 0; i < kMaxAuditFileBytes / long_name.size() + 2; ++i)
      audit.note(entry(long_name));
  }
  EXPECT_TRUE(std::filesystem::exists(folder_ / "audit/audit-000002.jsonl"));
  EXPECT_EQ(broken(), "");
  {
    Audit audit(folder_ / "audit", 0);
    audit.note(entry("after a start"));
  }
  EXPECT_EQ(broken(), "");
  std::filesystem::remove(first_file());
  EXPECT_EQ(broken(), "") << "the oldest files go";
}

TEST_F(AuditTest, AFolderThatCannotBeIsNoStart) {
  std::ofstream(folder_ / "audit") << "in the way";
  EXPECT_THROW(Audit(folder_ / "audit", 0), SetupError);
}

}  // namespace
}  // namespace hermite::server
