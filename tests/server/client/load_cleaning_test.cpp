#include "server/client/load_cleaning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "server/client/json_call.h"
#include "tests/support/listed_scans.h"

namespace hermite::client::load_cleaning_test {
namespace {

using testing::HasSubstr;

class LoadCleaningTest : public test::ListedScans {
 protected:
  LoadCleaningTest() {
    serve_rows(3, [](server::ScanRow& row, int i) {
      row.title = "load test, camera 1, scan " + std::to_string(i + 1);
    });
  }
};

TEST_F(LoadCleaningTest, DeletesTheScansOfTheTestOnly) {
  const LoadCleaning cleaning =
      clear_load_scans(target_, {ids_[0], ids_[2]}, false, [] { return false; });
  EXPECT_EQ(cleaning.deleted, 2u);
  EXPECT_TRUE(cleaning.left.empty());
  EXPECT_EQ(cleaning.why_left, "");
  const auto scans = list_scans(target_, 10);
  ASSERT_EQ(scans->size(), 1u);
  EXPECT_EQ(scans->front().id, ids_[1]);
}

TEST_F(LoadCleaningTest, TagsWhatIsKept) {
  const LoadCleaning cleaning = clear_load_scans(target_, ids_, true, [] { return false; });
  EXPECT_EQ(cleaning.deleted, 0u);
  EXPECT_EQ(cleaning.left, ids_);
  EXPECT_NE(cleaning.why_left, "");
  for (const std::string& id : ids_)
    EXPECT_EQ(show_scan(target_, id)->tags, std::vector<std::string>{kLoadTag});
}

TEST_F(LoadCleaningTest, SaysThatTheTokenMayNotDelete) {
  const auto made = json_call(target_.server, nullptr,
                              {"POST", "/api/v1/tokens", {}, R"({"scopes": ["view", "scan"]})"});
  ASSERT_TRUE(made.ok()) << made.error().message;
  target_.server.token = text_member(*made, "secret");
  const LoadCleaning cleaning = clear_load_scans(target_, ids_, false, [] { return false; });
  EXPECT_EQ(cleaning.left, ids_);
  EXPECT_THAT(cleaning.why_left, HasSubstr("scope admin"));
  EXPECT_EQ(list_scans(target_, 10)->size(), 3u);
}

TEST_F(LoadCleaningTest, EndsWhenItIsGivenUp) {
  const LoadCleaning cleaning = clear_load_scans(target_, ids_, false, [] { return true; });
  EXPECT_EQ(cleaning.left, ids_);
  EXPECT_THAT(cleaning.why_left, HasSubstr("interrupted"));
  EXPECT_EQ(list_scans(target_, 10)->size(), 3u);
}

}  // namespace
}  // namespace hermite::client::load_cleaning_test
