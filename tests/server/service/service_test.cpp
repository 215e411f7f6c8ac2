#include "server/service/service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>

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
  EXPECT_THAT(words(options), HasSubstr("--max-scans is 0"));
  options = test::test_options(folder / "data");
  options.credit_window = 1000;
  EXPECT_THAT(words(options), HasSubstr("--credit-window is 1000"));
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
