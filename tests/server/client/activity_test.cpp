// What runs on a server is read from a real one; the scans of operators_test.py run.
#include "server/client/activity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/listed_scans.h"

namespace hermite::client::activity_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

using ActivityOfAServer = test::ListedScans;

TEST(Metrics, AreThoseWithoutLabels) {
  EXPECT_THAT(metric_values("# HELP a_total what it counts\n# TYPE a_total counter\na_total 3\n"
                            "b{x=\"1\"} 4\nc 2.5e9\nd seven\n\ne"),
              ElementsAre(Pair("a_total", 3), Pair("c", 2.5e9)));
  EXPECT_TRUE(metric_values("").empty());
}

TEST_F(ActivityOfAServer, LeavesOutWhatHasEnded) {
  serve_rows(3, [](server::ScanRow&, int) {});
  ActivityReader reader(target_, std::nullopt);
  for (int reading = 0; reading < 2; ++reading) {
    const Result<Activity> activity = reader.read();
    ASSERT_TRUE(activity.ok()) << activity.error().message;
    EXPECT_TRUE(activity->scans.empty());
    EXPECT_TRUE(activity->jobs && activity->jobs->empty());
    EXPECT_FALSE(activity->load);
  }
}

TEST_F(ActivityOfAServer, NeedsATokenAndAnAddressThatAnswers) {
  serve_rows(0, [](server::ScanRow&, int) {});
  ServerUrl nobody = target_.server;
  nobody.port = 1;
  const Result<Activity> without_metrics = ActivityReader(target_, nobody).read();
  ASSERT_FALSE(without_metrics.ok());
  EXPECT_THAT(without_metrics.error().message, HasSubstr("the metrics: "));
  target_.server.token = "wrong";
  EXPECT_EQ(ActivityReader(target_, std::nullopt).read().error().code, ErrorCode::kUnauthorized);
}

}  // namespace
}  // namespace hermite::client::activity_test
