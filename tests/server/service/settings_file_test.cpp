#include "server/service/settings_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/service/settings.h"

namespace hermite::server::settings_file_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string message_of(const Status& status) {
  return status.ok() ? "well" : status.error().message;
}

std::string config_message(const std::string& text) {
  ServiceOptions options;
  return message_of(apply_config(options, text));
}

TEST(SettingsFile, WhatIsPrintedReadsBack) {
  ServiceOptions options;
  options.listen = "[::1]:99";
  options.data_folder = "/a folder, with = and # and \\ in it";
  options.allow_hosts = {"a.example", "b.example"};
  options.max_scans = 64;
  options.insecure_listen = true;
  options.drain_s = 0;
  const std::string printed = format_config(options, {});
  ServiceOptions read;
  ASSERT_EQ(message_of(apply_config(read, printed)), "well") << printed;
  EXPECT_EQ(format_config(read, {}), printed);
  EXPECT_EQ(read.data_folder, options.data_folder);
  EXPECT_EQ(read.allow_hosts, options.allow_hosts);
  EXPECT_TRUE(read.insecure_listen);
}

TEST(SettingsFile, EveryOneIsPrintedWithItsLimitsDefaultAndVariable) {
  const std::string printed = format_config({}, {});
  for (const ServiceSetting& setting : list_settings(ServiceOptions())) {
    EXPECT_THAT(printed, HasSubstr("\n" + setting.key + " = " + setting.value + "\n"));
    EXPECT_THAT(printed, HasSubstr("# " + setting.description + "\n"));
    EXPECT_THAT(printed, HasSubstr("environment: " + setting.environment));
    EXPECT_THAT(setting.environment, testing::MatchesRegex("HERMITE_SERVE_[A-Z0-9_]+"));
  }
  EXPECT_THAT(printed, HasSubstr("# default: 16; allowed: 1 to 256 frames; environment: "
                                 "HERMITE_SERVE_CREDIT_WINDOW\ncredit-window = 16\n"));
}

TEST(SettingsFile, TheFileTakesCommentsAndSpaces) {
  ServiceOptions options;
  const std::string text =
      "# a comment\r\n\r\n  max-scans=7 # seven\r\n"
      "allow-host = [ \"a\" , \"b#c\", ] # two\n"
      "device = \"\"\nlisten = \"127.0.0.1:1\" # x\ninsecure-i-know = true";
  ASSERT_EQ(message_of(apply_config(options, text)), "well");
  EXPECT_EQ(options.max_scans, 7);
  EXPECT_THAT(options.allow_hosts, ElementsAre("a", "b#c"));
  EXPECT_EQ(options.listen, "127.0.0.1:1");
  EXPECT_TRUE(options.insecure_listen);
}

TEST(SettingsFile, MistakesAreNamedWithTheirLine) {
  EXPECT_THAT(config_message("max-scans = 2\nmax-scans = 3"),
              AllOf(HasSubstr("line 2, max-scans = 3: "), HasSubstr("redefine")));
  EXPECT_EQ(config_message("max-scans = 0"),
            "line 1, max-scans = 0: setting max-scans is '0', allowed is 1 to 64 scans");
  EXPECT_EQ(config_message("\r\nmax-scans = 65\r\n"),
            "line 2, max-scans = 65: setting max-scans is '65', allowed is 1 to 64 scans");
  for (const char* number : {"4.5", "99999999999999999999", "x", "-1", "1 2", "nan", "\"\"",
                             "1979-05-27", "{ a = 1 }", "[[1]]"})
    EXPECT_THAT(config_message("max-scans = " + std::string(number)), HasSubstr("max-scans"))
        << number;
  EXPECT_THAT(config_message("log-level = \"loud\""),
              HasSubstr("setting log-level is 'loud', allowed is debug, info, warn or error"));
  EXPECT_THAT(config_message("insecure-i-know = yes"), HasSubstr("line 1, insecure-i-know = yes"));
  EXPECT_THAT(config_message("insecure-i-know = 1"), HasSubstr("allowed is true or false"));
  EXPECT_THAT(config_message("max-scan = 4"),
              AllOf(HasSubstr("line 1"), HasSubstr("there is no setting 'max-scan'")));
  EXPECT_THAT(config_message("[serve]\nmax-scans = 4"), HasSubstr("no tables"));
  EXPECT_THAT(config_message("a.b = 4"), HasSubstr("no tables"));
  EXPECT_THAT(config_message("max-scans"), HasSubstr("line 1, max-scans: "));
  EXPECT_THAT(config_message("listen = [\"a\", \"b\"]"), HasSubstr("takes one value, given are 2"));
  for (const char* cut :
       {"\"a", "[\"a\"", "[\"a\", b]", "[\"a\" \"b\"]", "\"a\" b", "[\"a\"] x", "", "[", "{}"})
    EXPECT_THAT(config_message("allow-host = " + std::string(cut)), HasSubstr("allow-host")) << cut;
  EXPECT_THAT(config_message(std::string(kMaxConfigBytes + 1, '#')),
              HasSubstr("longer than 65536"));
  EXPECT_THAT(config_message("data = \"" + std::string(5000, 'x') + "\""),
              AllOf(HasSubstr("longer than 4096"), testing::SizeIs(testing::Lt(200))));
  EXPECT_THAT(config_message(std::string("data = \"a\0b\"", 12)), HasSubstr("line 1, data"));
  EXPECT_THAT(config_message("data = \"a\\nb\""), HasSubstr("control character"));
  EXPECT_THAT(config_message("data = " + std::string(1000, '[')), HasSubstr("line 1, data"));
}

}  // namespace
}  // namespace hermite::server::settings_file_test
