// A load test of the real server, in one process.
#include "server/client/load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/source/open_sequence.h"
#include "server/client/load_report.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::client::load_test {
namespace {

using testing::Each;
using testing::Gt;
using testing::HasSubstr;
using testing::StartsWith;

class LoadTest : public testing::Test {
 protected:
  void serve(int max_scans) {
    server::ServiceOptions options = test::test_options(folder_.path());
    options.max_scans = max_scans;
    options.live_rate_hz = 1;  // so that the second camera gets its place on a slow machine, too
    server_ = std::make_unique<test::RunningServer>(options);
    plan_.request.server = {"127.0.0.1", static_cast<std::uint16_t>(server_->port()),
                            server_->token()};
    plan_.request.title = "load test";
    plan_.request.settings = {{"output.unstable", "true"}};  // a few frames make no stable surfels
    plan_.request.pacing = {.rate_hz = 10, .newest_wins = true};
    plan_.api.server = plan_.request.server;
    plan_.cameras = 2;
  }

  Result<LoadResult> run(const std::string& sequence) {
    LoadObserver observer;
    observer.interrupt_count = [] { return 0; };
    observer.on_progress = [this](const LoadProgress& progress) { last_progress_ = progress; };
    return run_load(**source::open_sequence(sequence), plan_, observer);
  }

  const test::TemporaryFolder folder_;
  std::unique_ptr<test::RunningServer> server_;
  LoadPlan plan_;
  LoadProgress last_progress_;
};

TEST_F(LoadTest, AccountsForEveryFrameAndLeavesNothing) {
  serve(2);
  plan_.viewers = 2;
  plan_.time = std::chrono::duration<double>(3);
  const Result<LoadResult> result = run("synthetic:frames=20,width=160,height=120");
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_TRUE(all_got_through(*result)) << format_load_report(*result);
  ASSERT_EQ(result->cameras.size(), 2u);
  for (const CameraLoad& camera : result->cameras) {
    EXPECT_EQ(camera.offered, camera.sent + camera.client_dropped + camera.left_out);
    EXPECT_EQ(camera.sent, camera.answered + camera.server_dropped);
    EXPECT_GT(camera.answered, 0u);
    EXPECT_GE(camera.due, camera.offered);
    // Each result is seen by itself, which AnswerTimes relies on.
    EXPECT_EQ(camera.answer_ms.size(), camera.answered);
    EXPECT_THAT(camera.answer_ms, Each(Gt(0)));
    EXPECT_GT(camera.sent_bytes, 0u);
  }
  EXPECT_GE(result->seconds, 3);
  EXPECT_FALSE(result->interrupted);
  EXPECT_GE(result->viewers.watched, 1u);
  EXPECT_GE(result->viewers.snapshot_ms.size(), 1u);
  EXPECT_GT(result->viewers.received_bytes, 0u);
  EXPECT_GT(result->viewers.sent_bytes, 0u);
  EXPECT_EQ(result->viewers.refused + result->viewers.disconnected, 0u)
      << format_load_report(*result);
  EXPECT_TRUE(result->machine.has_server_too);
  EXPECT_GT(result->machine.cores_used, 0);
  EXPECT_GE(result->cleaning.deleted, sum_of(result->cameras).scans_begun);
  EXPECT_TRUE(result->cleaning.left.empty()) << result->cleaning.why_left;
  EXPECT_TRUE(list_scans(plan_.api, 10)->empty());
  EXPECT_GT(last_progress_.answered, 0u);
}

TEST_F(LoadTest, SaysThatACameraGotNoPlaceAndKeepsTheScansIfWished) {
  serve(1);
  plan_.keep = true;
  plan_.time = std::chrono::duration<double>(1.5);
  const Result<LoadResult> result = run("synthetic:frames=100,width=160,height=120");
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_FALSE(all_got_through(*result));
  const CameraLoad all = sum_of(result->cameras);
  EXPECT_EQ(all.scans_finished, 1u) << format_load_report(*result);
  EXPECT_EQ(all.refused, 0u);
  EXPECT_TRUE(all.without_place);
  ASSERT_EQ(all.wait_s.size(), 1u);
  EXPECT_GT(all.wait_s.front(), 0);
  const auto scans = list_scans(plan_.api, 10);
  ASSERT_GE(scans->size(), 1u);
  EXPECT_EQ(scans->size(), result->cleaning.left.size());
  EXPECT_THAT(scans->front().title, StartsWith("load test, camera "));
  EXPECT_EQ(scans->front().tags, std::vector<std::string>{"load test"});
}

TEST_F(LoadTest, GivesUpWhereTheServerWouldOnlySayTheSameAgain) {
  serve(1);
  plan_.request.server.token = plan_.api.server.token = "not the token";
  const Result<LoadResult> result = run("synthetic:frames=5,width=160,height=120");
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_FALSE(all_got_through(*result));
  EXPECT_EQ(sum_of(result->cameras).refused, 2u);
  EXPECT_THAT(format_load_report(*result), HasSubstr("refused  2 x the server says: "));
  EXPECT_LT(result->seconds, 60) << "it did not wait for the end of the time";
}

}  // namespace
}  // namespace hermite::client::load_test
