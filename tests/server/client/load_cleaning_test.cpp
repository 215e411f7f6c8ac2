#include "server/client/load_cleaning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "server/client/json_call.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::load_cleaning_test {
namespace {

using testing::HasSubstr;

class LoadCleaningTest : public testing::Test {
 protected:
  LoadCleaningTest() {
    std::filesystem::create_directories(folder_ / "data");
    {
      Store store(folder_ / "data/hermite.db");
      for (int i = 0; i < 3; ++i) {
        ScanRow row;
        row.id = new_scan_id();
        row.title = "load test, camera 1, scan " + std::to_string(i + 1);
        row.phase = ScanPhase::kFinished;
        row.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
        row.created_at_ms = 1'714'564'800'000 + i;
        row.finished_at_ms = row.created_at_ms + 60'000;
        EXPECT_TRUE(store.scans.add(row).ok());
        ids_.push_back(row.id);
      }
    }
    server_ = std::make_unique<test::RunningServer>(test::test_options(folder_ / "data"));
    target_.server = {"127.0.0.1", static_cast<std::uint16_t>(server_->port()), server_->token(), false};
  }

  const test::TemporaryFolder folder_;
  std::vector<std::string> ids_;
  std::unique_ptr<test::RunningServer> server_;
  ApiTarget target_;
};

TEST_F(LoadCleaningTest, DeletesTheScansOfTheTestOnly) {
  const LoadCleaning cleaning = clear_load_scans(target_, {ids_[0], ids_[2]}, false, [] { return false; });
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
  for (const std::string& id : ids_) EXPECT_EQ(show_scan(target_, id)->tags, std::vector<std::string>{kLoadTag});
}

TEST_F(LoadCleaningTest, SaysThatTheTokenMayNotDelete) {
  const auto made = json_call(target_.server, nullptr, {"POST", "/api/v1/tokens", {}, R"({"scopes": ["view", "scan"]})"});
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
}  // namespace hermite::load_cleaning_test
