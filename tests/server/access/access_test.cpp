#include "server/access/access.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::server {
namespace {

using testing::HasSubstr;

TEST(Access, TokensAreEqualOrNot) {
  EXPECT_TRUE(tokens_equal("abc", "abc"));
  EXPECT_TRUE(tokens_equal("", ""));
  EXPECT_FALSE(tokens_equal("abc", "abd"));
  EXPECT_FALSE(tokens_equal("abc", "ab"));
  EXPECT_FALSE(tokens_equal("", "a"));
}

TEST(Access, TheLoopbacksNamesAreAllowedWithAnyPort) {
  for (const char* host :
       {"localhost", "LOCALHOST:8080", "127.0.0.1", "127.0.0.1:1", "[::1]", "[::1]:65535"})
    EXPECT_TRUE(host_allowed(default_hosts(), host)) << host;
}

TEST(Access, OtherHostsAreNot) {
  for (const char* host :
       {"", "evil.com", "localhost.evil.com", "evil.com:80", "127.0.0.1.evil.com",
        "localhost:", "localhost:80x", "[::1", "::1", "localhost:80:80", "127.0.0.1:999999",
        " localhost", "[::1]evil", "localhost@evil.com"})
    EXPECT_FALSE(host_allowed(default_hosts(), host)) << host;
}

TEST(Access, TheOperatorsNamesAreAllowed) {
  AllowedHosts hosts = default_hosts();
  hosts.push_back("scan.example.org");
  EXPECT_TRUE(host_allowed(hosts, "scan.example.org:443"));
  EXPECT_TRUE(origin_allowed(hosts, "https://scan.example.org"));
  EXPECT_FALSE(host_allowed(hosts, "example.org"));
}

TEST(Access, OriginsMustBeHttpOfAnAllowedHost) {
  for (const char* origin : {"http://localhost:5173", "https://127.0.0.1", "http://[::1]:8080"})
    EXPECT_TRUE(origin_allowed(default_hosts(), origin)) << origin;
  for (const char* origin :
       {"null", "", "http://evil.com", "file://localhost", "localhost", "http://localhost/path",
        "http://evil.com#localhost", "http://user@localhost"})
    EXPECT_FALSE(origin_allowed(default_hosts(), origin)) << origin;
}

TEST(Access, AnAddressUsesUpTheAllowanceOfItsNetwork) {
  EXPECT_EQ(address_group("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(address_group("2001:db8:1:2:3:4:5:6"), "2001:db8:1:2::/64");
  EXPECT_EQ(address_group("2001:db8:1:2::9"), address_group("2001:db8:1:2:ffff::"));
  EXPECT_NE(address_group("2001:db8:1:2::9"), address_group("2001:db8:1:3::9"));
  EXPECT_EQ(address_group("fe80::1%eth0"), "fe80::/64");
  EXPECT_EQ(address_group("::ffff:192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(address_group("nonsense"), "nonsense");
}

TEST(Access, ListenAddresses) {
  const auto v4 = parse_listen_address("127.0.0.1:8080");
  ASSERT_TRUE(v4.ok());
  EXPECT_EQ(v4->host, "127.0.0.1");
  EXPECT_EQ(v4->port, 8080);
  EXPECT_EQ(url_of(*v4), "http://127.0.0.1:8080");
  const auto v6 = parse_listen_address("[::1]:0");
  ASSERT_TRUE(v6.ok());
  EXPECT_EQ(v6->host, "::1");
  EXPECT_EQ(url_of(*v6), "http://[::1]:0");
  EXPECT_EQ(parse_listen_address("localhost:80")->host, "127.0.0.1");
  for (const char* text : {"", "8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:x",
                           "::1:80", "example.org:80", "1.2.3:80"})
    EXPECT_THAT(parse_listen_address(text).error().message,
                HasSubstr(std::string("\"") + text + "\""));
}

TEST(Access, FramesAreForNobodyOrForTheSitesThatAreNamed) {
  EXPECT_EQ(*frame_ancestors({}), "'none'");
  EXPECT_EQ(*frame_ancestors({"https://example.org", "http://*.lab.example:8080", "*"}),
            "https://example.org http://*.lab.example:8080 *");
  for (const char* site :
       {"", "example.org", "https://", "https://*", "https://a b", "https://a;script-src *",
        "https://a\r\nX: y", "https://a/b", "https://a:", "https://a:123456", "https://a:8x",
        "https://*.*.a", "ftp://a", "'self'", "data:"})
    EXPECT_THAT(frame_ancestors({"https://example.org", site}).error().message,
                HasSubstr("'" + std::string(site) + "'"));
}

TEST(Access, LoopbackIsTheWholeOf127AndTheOneOfIpv6) {
  for (const char* text : {"127.0.0.1:1", "127.3.2.1:1", "[::1]:1"})
    EXPECT_TRUE(is_loopback(*parse_listen_address(text))) << text;
  for (const char* text : {"0.0.0.0:1", "192.168.0.1:1", "[::]:1", "128.0.0.1:1"})
    EXPECT_FALSE(is_loopback(*parse_listen_address(text))) << text;
}

}  // namespace
}  // namespace hermite::server
