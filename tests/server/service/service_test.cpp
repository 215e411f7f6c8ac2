#include "server/service/service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite {
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
    client.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + headers + "\r\n");
    return client.read_to_end().substr(0, 12);
  };
  EXPECT_EQ(status(""), "HTTP/1.1 403");
  EXPECT_EQ(status("X-Forwarded-Proto: http\r\n"), "HTTP/1.1 403");
  EXPECT_EQ(status("X-Forwarded-Proto: https\r\nX-Forwarded-Proto: http\r\n"), "HTTP/1.1 403") << "the last one is the proxy's";
  EXPECT_EQ(status("X-Forwarded-Proto: https\r\nX-Forwarded-For: 198.51.100.4\r\n"), "HTTP/1.1 200");
  test::RawClient camera(server.port());
  EXPECT_THAT(camera.upgrade("Host: localhost\r\nSec-WebSocket-Protocol: hermite.v1\r\n"), HasSubstr(" 403 "));
}

TEST(Service, SaysWhatIsWrongWithItsOptions) {
  const test::TemporaryFolder folder;
  const auto words = [](const ServiceOptions& options) -> std::string {
    try {
      const Service service(options);
    } catch (const SetupError& error) {
      return error.what();
    }
    return "started";
  };
  ServiceOptions options = test::test_options(folder / "data");
  options.listen = "nonsense";
  EXPECT_THAT(words(options), HasSubstr("nonsense"));
  options = test::test_options(folder / "data");
  options.max_scans = 0;
  EXPECT_THAT(words(options), HasSubstr("setting max-scans is '0', allowed is 1 to 64"));
  options = test::test_options(folder / "data");
  options.credit_window = 1000;
  EXPECT_THAT(words(options), HasSubstr("setting credit-window is '1000'"));
  const Service running(test::test_options(folder / "data"));
  EXPECT_THAT(words(test::test_options(folder / "data")), HasSubstr("another server"));
  options = test::test_options(folder / "other");
  options.listen = running.url().substr(7);
  EXPECT_THAT(words(options), HasSubstr("in use"));
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
}  // namespace hermite
