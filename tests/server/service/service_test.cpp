#include "server/service/service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>
#include <vector>

#include "server/client/api_request.h"
#include "server/store/data_directory.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "server/store/unix_time.h"
#include "tests/support/certificate.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

TEST(Service, RefusesAddressesThatOthersReach) {
  const test::TemporaryFolder folder;
  ServiceOptions options = test::test_options(folder / "data");
  options.listen = "0.0.0.0:0";
  try {
    const Service service(options);
    FAIL() << "listens";
  } catch (const SetupError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--insecure-i-know"));
  }
  options.insecure_listen = true;
  EXPECT_NO_THROW(Service service(options));
  options.insecure_listen = false;
  options.trusted_proxies = {"192.0.2.7"};
  EXPECT_NO_THROW(Service service(options));
}

TEST(Service, BehindAProxyOnAPublicAddressOnlyWhatItEncryptsIsAnswered) {
  const test::TemporaryFolder folder;
  ServiceOptions options = test::test_options(folder / "data");
  options.listen = "0.0.0.0:0";
  options.trusted_proxies = {"127.0.0.1"};
  const test::RunningServer server(options);
  const auto status = [&server](const std::string& headers) {
    test::RawClient client(server.port());
    client.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + headers +
                "\r\n");
    return client.read_to_end().substr(0, 12);
  };
  EXPECT_EQ(status(""), "HTTP/1.1 403");
  EXPECT_EQ(status("X-Forwarded-Proto: http\r\n"), "HTTP/1.1 403");
  EXPECT_EQ(status("X-Forwarded-Proto: https\r\nX-Forwarded-Proto: http\r\n"), "HTTP/1.1 403")
      << "the last one is the proxy's";
  EXPECT_EQ(status("X-Forwarded-Proto: https\r\nX-Forwarded-For: 198.51.100.4\r\n"),
            "HTTP/1.1 200");
  test::RawClient camera(server.port());
  EXPECT_THAT(camera.upgrade("Host: localhost\r\nSec-WebSocket-Protocol: hermite.v1\r\n"),
              HasSubstr(" 403 "));
}

// The log folder of a finished scan, without a server.
std::string add_logged_scan(const std::string& data_path, std::int64_t finished_at_ms) {
  const DataDirectory data(data_path);
  Store store(data.database_path());
  ScanRow row;
  row.id = new_scan_id();
  row.phase = ScanPhase::kFinished;
  row.finished_at_ms = finished_at_ms;
  row.camera = {160, 120, 131, 131, 79.5, 59.5, 5000};
  EXPECT_TRUE(store.scans.add(row).ok());
  std::filesystem::create_directories(data.log_folder(row.id));
  std::ofstream(data.log_folder(row.id) + "/segment-0000.rlog") << "frames";
  return data.log_folder(row.id);
}

// Whatever was wrong with a clock or a setting, there is time to notice.
TEST(Service, RemovesOldFramesOfTenScansAnHour) {
  constexpr std::int64_t kMonth_ms = 30LL * 24 * 3600 * 1000;
  const test::TemporaryFolder folder;
  std::vector<std::string> old;
  for (int i = 0; i < 13; ++i)
    old.push_back(add_logged_scan(folder / "data", unix_now_ms() - kMonth_ms));
  const std::string young = add_logged_scan(folder / "data", unix_now_ms());
  const test::RunningServer server(test::test_options(folder / "data"));
  const auto left = [&old] {
    return std::count_if(old.begin(), old.end(),
                         [](const auto& log) { return std::filesystem::exists(log); });
  };
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (left() > 3 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(left(), 3) << "they go an hour later";
  EXPECT_TRUE(std::filesystem::exists(young));
}

TEST(Service, SaysWhatIsWrongWithItsOptions) {
  const test::TemporaryFolder folder;
  const auto message_of = [](const ServiceOptions& options) -> std::string {
    try {
      const Service service(options);
    } catch (const SetupError& error) {
      return error.what();
    }
    return "started";
  };
  ServiceOptions options = test::test_options(folder / "data");
  options.listen = "nonsense";
  EXPECT_THAT(message_of(options), HasSubstr("nonsense"));
  options = test::test_options(folder / "data");
  options.max_scans = 0;
  EXPECT_THAT(message_of(options), HasSubstr("setting max-scans is '0', allowed is 1 to 64"));
  options = test::test_options(folder / "data");
  options.credit_window = 1000;
  EXPECT_THAT(message_of(options), HasSubstr("setting credit-window is '1000'"));
  options = test::test_options(folder / "data");
  options.failures_per_minute = 0;
  EXPECT_THAT(message_of(options),
              HasSubstr("setting failures-per-minute is '0', allowed is 1 to 1000"));
  const Service running(test::test_options(folder / "data"));
  EXPECT_THAT(message_of(test::test_options(folder / "data")), HasSubstr("another server"));
  options = test::test_options(folder / "other");
  options.listen = running.url().substr(7);
  EXPECT_THAT(message_of(options), HasSubstr("in use"));
}

TEST(Service, TooManyConnectionsOfAnAddressAreToldToWait) {
  const test::TemporaryFolder folder;
  ServiceOptions options = test::test_options(folder / "data");
  options.connections_per_address = 2;
  const test::RunningServer server(options);
  const std::string request = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
  std::optional<test::RawClient> first(std::in_place, server.port());
  test::RawClient second(server.port());
  for (test::RawClient* client : {&*first, &second}) {
    client->send(request);
    EXPECT_THAT(client->read_header(), HasSubstr(" 200 "));
  }
  test::RawClient third(server.port());
  third.send(request);
  const std::string refused = third.read_to_end();
  EXPECT_THAT(refused, HasSubstr(" 503 "));
  EXPECT_THAT(refused, HasSubstr("Retry-After: 5\r\n"));
  EXPECT_THAT(refused, HasSubstr("too many connections"));
  first.reset();
  // Until the server has noticed.
  std::string answer;
  for (int i = 0; i < 100 && answer.find(" 200 ") == std::string::npos; ++i) {
    test::RawClient again(server.port());
    again.send(request);
    answer = again.read_header();
  }
  EXPECT_THAT(answer, HasSubstr(" 200 "));
}

TEST(Service, TooManyRequestsOfAnAddressAreToldToWait) {
  const test::TemporaryFolder folder;
  ServiceOptions options = test::test_options(folder / "data");
  options.requests_per_second = 1;
  const test::RunningServer server(options);
  test::RawClient client(server.port());
  std::string answers;
  for (int i = 0; i < 4; ++i) client.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  answers = client.read_to_end();
  EXPECT_THAT(answers, HasSubstr(" 429 "));
  EXPECT_THAT(answers, HasSubstr("Retry-After: 1\r\n"));
  test::RawClient socket(server.port());
  EXPECT_FALSE(socket.upgrade()) << "an upgrade is a request too";
}

TEST(Service, ClientsOfATrustedProxyHaveTheirOwnAllowances) {
  const test::TemporaryFolder folder;
  ServiceOptions options = test::test_options(folder / "data");
  options.trusted_proxies = {"127.0.0.1"};
  options.connections_per_address = options.requests_per_second = 1;
  const test::RunningServer server(options);
  const auto ask = [](test::RawClient& proxy, const std::string& client) {
    proxy.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Forwarded-For: " + client +
               "\r\n\r\n");
    return proxy.read_header();
  };
  test::RawClient first(server.port()), second(server.port());
  for (const char* client :
       {"198.51.100.1", "198.51.100.2", "2001:db8:1:2::1", "2001:db8:1:3::1"}) {
    EXPECT_THAT(ask(first, client), HasSubstr(" 200 ")) << client;
    EXPECT_THAT(ask(second, client), HasSubstr(" 200 ")) << client;
  }
  std::string answer;
  for (int i = 0; i < 20 && answer.find(" 429 ") == std::string::npos; ++i)
    answer = ask(first, "2001:db8:1:2::2");
  EXPECT_THAT(answer, HasSubstr(" 429 ")) << "another address of the same customer";
}

TEST(Service, OneConnectionTooManyIsToldSoOverTlsToo) {
  const test::TemporaryFolder folder;
  const test::CertificateFiles files =
      test::make_certificate(folder.path(), "server", "IP:127.0.0.1");
  ServiceOptions options = test::test_options(folder / "data");
  options.tls_certificate = files.certificate;
  options.tls_key = files.key;
  options.max_connections = 1;
  const test::RunningServer server(options);
  const test::RawClient first(server.port());
  const Result<std::string> refused = client::api_request(
      {"127.0.0.1", static_cast<std::uint16_t>(server.port()), server.token(), true}, "GET",
      "/api/v1/scans", "");
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kBusy);
  EXPECT_EQ(refused.error().message, "too many connections are open");
}

TEST(Service, SaysWhereItListensToProgramsBesideIt) {
  const test::TemporaryFolder folder;
  const Service service(test::test_options(folder / "data"));
  const Result<PublishedServer> published = published_server(folder / "data");
  ASSERT_TRUE(published.ok());
  EXPECT_EQ(published->url, service.url());
  EXPECT_EQ(published->token, service.token());
}

TEST(Service, AStartTakesOutOfTheWayWhatNoRowKnowsAndWhatNobodyWants) {
  const test::TemporaryFolder folder;
  const std::string scan = new_scan_id(), upload = new_scan_id(), known = new_scan_id(),
                    removed = new_scan_id();
  {
    const DataDirectory data(folder / "data");
    Store store(data.database_path());
    ScanRow row;
    row.id = known;
    row.phase = ScanPhase::kFinished;
    row.camera = {160, 120, 131, 131, 79.5, 59.5, 5000};
    ASSERT_TRUE(store.scans.add(row).ok());
    for (const std::string& id : {scan, known, removed})
      ASSERT_TRUE(data.create_scan_folder(id).ok());
    std::ofstream(data.upload_path(upload)) << "half of it";
    ASSERT_TRUE(data.set_aside().discard_scan(removed).ok()) << "and here the server died";
  }
  test::RunningServer server(test::test_options(folder / "data"));
  EXPECT_TRUE(std::filesystem::exists(folder / ("data/scans/" + known)));
  EXPECT_TRUE(std::filesystem::exists(folder / ("data/lost/scans/" + scan)));
  EXPECT_TRUE(std::filesystem::exists(folder / ("data/lost/uploads/" + upload)));
  EXPECT_FALSE(std::filesystem::exists(folder / ("data/scans/" + scan)));
  // Beside everything else.
  for (int i = 0; i < 500 && !std::filesystem::is_empty(folder / "data/waste"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(std::filesystem::is_empty(folder / "data/waste"));
}

TEST(Service, AStartRemovesTheFramesOfScansThatEndedLongAgo) {
  const test::TemporaryFolder folder;
  constexpr std::int64_t kDay_ms = 24 * 3600 * 1000;
  std::string old, recent, running;
  {
    const DataDirectory data(folder / "data");
    Store store(data.database_path());
    const auto scan = [&](ScanPhase phase, std::int64_t finished_at_ms) {
      ScanRow row;
      row.id = new_scan_id();
      row.camera = {160, 120, 131, 131, 79.5, 59.5, 5000};
      EXPECT_TRUE(store.scans.add(row).ok());
      row.phase = phase;
      row.finished_at_ms = finished_at_ms;
      EXPECT_TRUE(store.scans.update(row).ok());
      std::filesystem::create_directories(data.log_folder(row.id));
      std::ofstream(data.scan_folder(row.id) + "/cloud.ply") << "points";
      return row.id;
    };
    old = scan(ScanPhase::kFinished, unix_now_ms() - 8 * kDay_ms);
    recent = scan(ScanPhase::kFinished, unix_now_ms() - 6 * kDay_ms);
    running = scan(ScanPhase::kRunning, 0);
  }
  test::RunningServer server(test::test_options(folder / "data"));
  const std::string scans = folder / "data/scans/";
  for (int i = 0; i < 500 && std::filesystem::exists(scans + old + "/log"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(std::filesystem::exists(scans + old + "/log"));
  EXPECT_TRUE(std::filesystem::exists(scans + old + "/cloud.ply")) << "results stay";
  EXPECT_TRUE(std::filesystem::exists(scans + recent + "/log"));
  EXPECT_TRUE(std::filesystem::exists(scans + running + "/log"));
}

TEST(Service, EndsWithASignal) {
  const test::TemporaryFolder folder;
  ServiceOptions options = test::test_options(folder / "data");
  options.stop_on_signals = true;
  Service service(options);
  std::thread signalling([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    kill(getpid(), SIGTERM);
  });
  EXPECT_TRUE(service.run());
  signalling.join();
}

TEST(Service, MayBeStoppedBeforeItRuns) {
  const test::TemporaryFolder folder;
  Service service(test::test_options(folder / "data"));
  service.stop();
  EXPECT_TRUE(service.run());
}

}  // namespace
}  // namespace hermite::server
