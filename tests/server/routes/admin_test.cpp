// Health, readiness and metrics of a real server, asked over HTTP on its admin address.
#include "server/routes/admin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "server/store/unix_time.h"
#include "tests/support/openapi_document.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class AdminTest : public testing::Test {
 protected:
  void serve(const ServiceOptions& options) {
    server_ = std::make_unique<test::RunningServer>(options);
  }
  ServiceOptions options() {
    ServiceOptions options = test::test_options(folder_ / "data");
    options.admin_listen = "127.0.0.1:0";
    options.min_free_disk_mb = 0;
    return options;
  }
  std::string ask(const std::string& method, const std::string& path, int port) {
    test::RawClient client(port);
    client.send(method + " " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    return client.read_to_end();
  }
  std::string get(const std::string& path) {
    return ask("GET", path, server_->service().admin_port());
  }

  // The answer once the GPU was opened or not.
  std::string readiness() {
    for (int i = 0; i < 300; ++i) {
      const std::string answer = get("/readyz");
      if (answer.find("still being opened") == std::string::npos) return answer;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return "never";
  }

  const test::TemporaryFolder folder_;
  std::unique_ptr<test::RunningServer> server_;
};

TEST_F(AdminTest, SaysThatItIsAliveAndReady) {
  serve(options());
  EXPECT_THAT(get("/healthz"), StartsWith("HTTP/1.1 200"));
  const std::string ready = readiness();
  EXPECT_THAT(ready, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(ready, HasSubstr("\r\n\r\nready\n"));
}

TEST_F(AdminTest, TheOpenApiDocumentHasItsRoutes) {
  serve(options());
  std::vector<std::string> described;
  for (const auto& [route, operation] : test::described_operations(test::openapi_document())) {
    if (route.find(" /api/") != std::string::npos) continue;
    ASSERT_THAT(route, StartsWith("GET /")) << "in " << test::kOpenApiFile;
    described.push_back(route.substr(4));
    EXPECT_THAT(get(described.back()), Not(HasSubstr("here are ")))
        << test::kOpenApiFile << " describes " << route;
  }
  EXPECT_THAT(described,
              testing::UnorderedElementsAre("/healthz", "/readyz", "/metrics", "/debug/trace"))
      << test::kOpenApiFile;
}

TEST_F(AdminTest, SaysWhatIsMissing) {
  ServiceOptions bad = options();
  bad.device = "no such GPU";
  bad.min_free_disk_mb = 1'000'000'000;
  serve(bad);
  const std::string answer = readiness();
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 503"));
  EXPECT_THAT(answer, HasSubstr("not ready: the disk: "));
  EXPECT_THAT(answer, HasSubstr("(min-free-disk)"));
  EXPECT_THAT(answer, HasSubstr("not ready: the GPU: "));
  EXPECT_THAT(answer, HasSubstr("no such GPU"));
}

TEST_F(AdminTest, SaysThatTheDiskTakesNoFiles) {
  serve(options());
  // This folder is in the way of the file that is tried.
  std::filesystem::create_directory(folder_ / "data/probe");
  EXPECT_THAT(readiness(), HasSubstr("not ready: the disk: making a file in "));
  std::filesystem::remove(folder_ / "data/probe");
  EXPECT_THAT(readiness(), StartsWith("HTTP/1.1 200"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "data/probe"));
}

// Where nobody looks at a start: in the log of a job that has ended.
TEST_F(AdminTest, SaysThatTheDatabaseIsDamaged) {
  const std::string path = folder_ / "data/hermite.db";
  std::filesystem::create_directory(folder_ / "data");
  {
    Store store(path);
    JobRow job;
    job.id = new_scan_id();
    job.state = JobState::kFinished;
    job.finished_at_ms = unix_now_ms();
    ASSERT_TRUE(store.jobs.add(job).ok());
    for (int i = 0; i < 100; ++i)
      ASSERT_TRUE(store.jobs.add_line(job.id, {i, std::string(500, 'x')}).ok());
  }
  constexpr std::uintmax_t kPageBytes = 4096;
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path) - kPageBytes + 8));
  file << std::string(2000, '\x7f');
  file.close();
  serve(options());
  std::string answer;
  for (int i = 0; i < 300 && answer.find("the database: ") == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    answer = get("/readyz");
  }
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 503"));
  EXPECT_THAT(answer, HasSubstr("restore a backup"));
  EXPECT_THAT(get("/metrics"), HasSubstr("hermite_database_damaged 1\n"));
  EXPECT_THAT(get("/healthz"), StartsWith("HTTP/1.1 200")) << "a restart would not help";
}

TEST_F(AdminTest, MetricsCountRequestsByRouteAndNeverByPath) {
  serve(options());
  ask("GET", "/healthz", server_->port());
  ask("GET", "/secret-path-of-a-client", server_->port());
  ask("GET", "/api/v1/scans", server_->port());
  const std::string text = get("/metrics");
  EXPECT_THAT(text, HasSubstr("Content-Type: text/plain; version=0.0.4"));
  for (const char* line :
       {"hermite_build_info{version=\"0.1.0\"} 1\n",
        "# TYPE hermite_frame_latency_seconds histogram\n",
        "hermite_scans_running{mode=\"live\"} 0\n", "hermite_scans_running{mode=\"batch\"} 0\n",
        "hermite_viewers 0\n", "hermite_jobs{state=\"queued\"} 0\n",
        "hermite_jobs{state=\"failed\"} 0\n", "hermite_frames_received_total 0\n",
        "hermite_frames_dropped_total 0\n", "hermite_authentication_failures_total 1\n",
        "hermite_queue_bytes{queue=\"frames\"} 0\n", "hermite_gpu_memory_limit_bytes 0\n",
        "hermite_scan_gpu_memory_bytes 0\n", "hermite_draining 0\n", "hermite_database_damaged 0\n",
        "hermite_http_request_duration_seconds_count{code=\"200\",route=\"healthz\"} 1\n",
        "hermite_http_request_duration_seconds_count{code=\"404\",route=\"other\"} 1\n"})
    EXPECT_THAT(text, HasSubstr(line));
  EXPECT_THAT(text, Not(HasSubstr("secret-path")));
  EXPECT_THAT(text, Not(HasSubstr("hermite_disk_free_bytes 0\n")));
  EXPECT_THAT(text, Not(HasSubstr(server_->token())));
}

TEST_F(AdminTest, KeepsItsRoutesApartFromTheViewers) {
  serve(options());
  for (const char* path : {"/metrics", "/readyz", "/debug/trace?scan=x"})
    EXPECT_THAT(ask("GET", path, server_->port()), StartsWith("HTTP/1.1 404")) << path;
  EXPECT_THAT(get("/api/v1/scans"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(get("/"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(get("/debug/trace"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(get("/debug/trace?scan=../../x"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(ask("DELETE", "/metrics", server_->service().admin_port()),
              StartsWith("HTTP/1.1 405"));
  test::RawClient upgrading(server_->service().admin_port());
  EXPECT_FALSE(upgrading.upgrade()) << "no WebSockets here";
  test::RawClient rebound(server_->service().admin_port());
  rebound.send("GET /metrics HTTP/1.1\r\nHost: evil.example\r\n\r\n");
  EXPECT_THAT(rebound.read_to_end(), StartsWith("HTTP/1.1 403"));
}

TEST_F(AdminTest, IsOffOrOnTheLoopbackAddress) {
  ServiceOptions off = options();
  off.admin_listen = "off";
  serve(off);
  EXPECT_EQ(server_->service().admin_port(), 0);
  ServiceOptions open = test::test_options(folder_ / "other");
  for (const char* address : {"0.0.0.0:0", "nonsense"}) {
    open.admin_listen = address;
    try {
      const Service service(open);
      ADD_FAILURE() << address;
    } catch (const SetupError& error) {
      EXPECT_THAT(error.what(), HasSubstr("--admin-listen"));
    }
  }
}

}  // namespace
}  // namespace hermite::server
