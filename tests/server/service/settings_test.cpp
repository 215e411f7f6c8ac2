#include "server/service/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string message_of(const Status& status) {
  return status.ok() ? "well" : status.error().message;
}

TEST(Settings, TheEnvironmentCountsAfterWhatIsThereAndMisspeltNamesAreRefused) {
  ServiceOptions options;
  options.max_scans = 2;
  options.drain_s = 5;
  const char* const variables[] = {
      "PATH=/bin",       "HERMITE_SERVE_MAX_SCANS=3", "HERMITE_SERVE_ALLOW_HOST=a, b",
      "HERMITE_OTHER=1", "HERMITE_SERVE_CONFIG=x",    nullptr};
  ASSERT_EQ(message_of(apply_environment(options, variables)), "well");
  EXPECT_EQ(options.max_scans, 3);
  EXPECT_EQ(options.drain_s, 5);
  EXPECT_THAT(options.allow_hosts, ElementsAre("a", "b"));
  const char* const misspelt[] = {"HERMITE_SERVE_MAX_SCAN=3", nullptr};
  EXPECT_THAT(message_of(apply_environment(options, misspelt)),
              HasSubstr("HERMITE_SERVE_MAX_SCAN, which is no setting"));
  const char* const bad[] = {"HERMITE_SERVE_MAX_SCANS=many", nullptr};
  EXPECT_EQ(message_of(apply_environment(options, bad)),
            "HERMITE_SERVE_MAX_SCANS: setting max-scans is 'many', allowed is 1 to 64 scans");
}

TEST(Settings, WhatHoldsBetweenThemIsChecked) {
  ServiceOptions options;
  EXPECT_EQ(message_of(check(options)), "well");
  options.tls_certificate = "cert.pem";
  EXPECT_THAT(message_of(check(options)), HasSubstr("tls-certificate and tls-key go together"));
  options = {};
  options.credit_window = 1000;
  EXPECT_THAT(message_of(check(options)),
              HasSubstr("setting credit-window is '1000', allowed is 1 to 256 frames"));
}

}  // namespace
}  // namespace hermite::server
