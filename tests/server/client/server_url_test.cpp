#include "server/client/server_url.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::client {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ServerUrl, HttpAndWebSocketFormsAreTheSamePlace) {
  const ServerUrl expected{"127.0.0.1", 8080, ""};
  for (const char* text : {"http://127.0.0.1:8080", "ws://127.0.0.1:8080", "http://127.0.0.1:8080/",
                           "ws://127.0.0.1:8080/"}) {
    const auto url = parse_server_url(text);
    ASSERT_TRUE(url.ok()) << url.error().message;
    EXPECT_EQ(*url, expected) << text;
  }
}

TEST(ServerUrl, TakesTheTokenFromTheAddressTheServerPrints) {
  EXPECT_EQ(*parse_server_url("http://127.0.0.1:8080/#token=abc-DEF_123"),
            (ServerUrl{"127.0.0.1", 8080, "abc-DEF_123"}));
  EXPECT_EQ(parse_server_url("http://h:1#token=t")->token, "t");
  EXPECT_EQ(parse_server_url("http://h:1/#scan=7&token=t&x=1")->token, "t");
  EXPECT_EQ(parse_server_url("http://h:1/#mytoken=t")->token, "");
  EXPECT_EQ(parse_server_url("http://h:1/#")->token, "");
}

TEST(ServerUrl, PortDefaultsTo80AndNamesAndIpv6AreHosts) {
  EXPECT_EQ(*parse_server_url("http://scanner.example"), (ServerUrl{"scanner.example", 80, ""}));
  EXPECT_EQ(*parse_server_url("ws://[::1]:9000/"), (ServerUrl{"::1", 9000, ""}));
  EXPECT_EQ(parse_server_url("ws://[::1]:9000")->host_and_port(), "[::1]:9000");
  EXPECT_EQ(parse_server_url("http://scanner.example")->host_and_port(), "scanner.example:80");
}

TEST(ServerUrl, NonsenseIsRefusedWithAMessage) {
  for (const char* text :
       {"", "127.0.0.1:8080", "ftp://h:1", "http://", "http://:8080", "http://h:0",
        "http://h:65536", "http://h:", "http://h:8a", "http://a b:1", "http://u@h:1", "http://[::1",
        "http://[::1]x", "http://[g]:1", "http://h:1/api", "http://h:1?x=1"}) {
    const auto url = parse_server_url(text);
    ASSERT_FALSE(url.ok()) << text;
    EXPECT_EQ(url.error().code, ErrorCode::kInvalidArgument) << text;
    EXPECT_THAT(url.error().message, HasSubstr(std::string("\"") + text + "\""));
  }
}

TEST(ServerUrl, TlsHasItsOwnSchemesAndPort) {
  for (const char* text : {"https://h", "wss://h/"})
    EXPECT_EQ(*parse_server_url(text), (ServerUrl{"h", 443, "", true})) << text;
  EXPECT_EQ(*parse_server_url("https://[::1]:8443/#token=t"), (ServerUrl{"::1", 8443, "t", true}));
}

TEST(ServerUrl, ErrorsNeverShowTheToken) {
  EXPECT_THAT(parse_server_url("http://h:0/#token=secret").error().message,
              Not(HasSubstr("secret")));
  EXPECT_THAT(parse_server_url("https://h/x#token=secret").error().message,
              Not(HasSubstr("secret")));
}

}  // namespace
}  // namespace hermite::client
