#include "server/service/service_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite::server {
namespace {

using ::testing::HasSubstr;

// What a function says that throws.
template <class Function>
std::string setup_error_of(Function function) {
  try {
    function();
  } catch (const SetupError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ServiceSetup, GigabytesAndHoursBecomeBytesAndMilliseconds) {
  ServiceOptions options;
  options.max_upload_gb = 3;
  options.uploads_per_token_gb = 5;
  options.min_free_disk_mb = 7;
  options.keep_upload_hours = 2;
  const UploadLimits limits = upload_limits(options);
  EXPECT_EQ(limits.upload_bytes, 3'000'000'000);
  EXPECT_EQ(limits.token_bytes, 5'000'000'000);
  EXPECT_EQ(limits.min_free_disk_bytes, 7'000'000u);
  EXPECT_EQ(limits.keep_ms, 7'200'000);
}

TEST(ServiceSetup, AnAddressOfThisMachineMayBeAskedFor) {
  ServiceOptions options;
  options.allow_hosts = {"scan.example"};
  const AllowedHosts hosts = allowed_hosts(options, {"fd00::1", 8080});
  EXPECT_TRUE(host_allowed(hosts, "[fd00::1]:8080"));
  EXPECT_TRUE(host_allowed(hosts, "scan.example"));
  EXPECT_TRUE(host_allowed(hosts, "localhost"));
  EXPECT_FALSE(host_allowed(hosts, "other.example"));
}

TEST(ServiceSetup, MonitoringCanBeOffAndIsForThisMachine) {
  ServiceOptions options;
  options.admin_listen = "off";
  EXPECT_FALSE(checked_admin_address(options));
  options.admin_listen = "0.0.0.0:9464";
  EXPECT_THAT(setup_error_of([&] { checked_admin_address(options); }),
              HasSubstr("--admin-listen 0.0.0.0:9464"));
  options.insecure_listen = true;
  EXPECT_EQ(checked_admin_address(options)->port, 9464);
}

TEST(ServiceSetup, SaysWhichAddressIsTaken) {
  boost::asio::io_context context;
  const auto first = open_port(context, {"127.0.0.1", 0});
  const std::uint16_t port = first.local_endpoint().port();
  EXPECT_THAT(setup_error_of([&] {
                open_port(context, {"127.0.0.1", port});
              }),
              HasSubstr("http://127.0.0.1:" + std::to_string(port)));
}

TEST(ServiceSetup, AProxyThatIsNoNetworkIsNamed) {
  ServiceOptions options;
  options.trusted_proxies = {"10.0.0.0/8", "10.0.0.0/33"};
  EXPECT_THAT(setup_error_of([&] { proxies_of(options); }), HasSubstr("--trusted-proxy"));
}

}  // namespace
}  // namespace hermite::server
