// The protocol before a scan has begun: upgrade, hello, limits. No GPU needed.
#include "server/connections/websocket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "server/store/scan_id.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using test::RawClient;
using testing::HasSubstr;
using testing::StartsWith;

class WebSocketTest : public testing::Test {
 protected:
  wire::Hello viewer_of(const std::string& scan_id) const {
    return {0, "test", server_.token(), wire::ViewScan{scan_id}};
  }
  wire::Hello camera_with(std::map<std::string, std::string> settings) const {
    wire::StartScan start;
    start.title = "t";
    start.camera = {160, 120, 131, 131, 79.5, 59.5, 5000};
    start.depth_codecs = {wire::DepthCodec::kRvlZstd};
    start.color_codecs = {wire::ColorCodec::kJpeg};
    start.settings = std::move(settings);
    return {0, "test", server_.token(), start};
  }

  // What a first message brings: the message of the error and the close code.
  struct Refused {
    wire::ErrorMessage error;
    int close_code = 0;
  };
  Refused first_message(int opcode, const std::string& bytes) {
    RawClient client(server_.port());
    EXPECT_TRUE(client.upgrade());
    client.send_frame(opcode, bytes);
    Refused refused;
    if (const auto error = client.read<wire::ErrorMessage>()) refused.error = *error;
    refused.close_code = client.close_code();
    return refused;
  }
  Refused first_message(wire::ClientMessage message) {
    return first_message(2, wire::format_client_message(std::move(message)));
  }

  const test::TemporaryFolder folder_;
  test::RunningServer server_{test::test_options(folder_ / "data")};
};

TEST_F(WebSocketTest, TheUpgradeIsChecked) {
  const std::string protocol = "Sec-WebSocket-Protocol: hermite.v1\r\n",
                    host = "Host: 127.0.0.1\r\n";
  const auto answer = [&](const std::string& headers, const std::string& path = wire::kEndpoint) {
    RawClient client(server_.port());
    return client.upgrade(headers, path);
  };
  const std::string good = answer(host + protocol);
  EXPECT_THAT(good, StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(good, HasSubstr("Sec-WebSocket-Protocol: hermite.v1\r\n"));
  EXPECT_THAT(answer(host + "Sec-WebSocket-Protocol: other, hermite.v1\r\n"),
              StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(answer(host + protocol + "Origin: http://localhost:8080\r\n"),
              StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(answer(host), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(answer(host + "Sec-WebSocket-Protocol: hermite.v2\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(answer(host + protocol, "/other"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(answer("Host: evil.com\r\n" + protocol), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(answer(host + protocol + "Origin: http://evil.com\r\n"), StartsWith("HTTP/1.1 403"));
}

TEST_F(WebSocketTest, CompressionIsNotOffered) {
  RawClient client(server_.port());
  const std::string answer = client.upgrade(
      "Host: localhost\r\nSec-WebSocket-Protocol: hermite.v1\r\nSec-WebSocket-Extensions: "
      "permessage-deflate; client_max_window_bits\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(answer, testing::Not(HasSubstr("deflate")));
}

TEST_F(WebSocketTest, AWrongTokenIsUnauthorized) {
  for (const std::string& token :
       {std::string(), std::string("wrong"), server_.token() + "0", std::string(64, '0')}) {
    const Refused refused = first_message(wire::Hello{0, "test", token, wire::ViewScan{"a"}});
    EXPECT_EQ(refused.error.code, "unauthorized");
    EXPECT_EQ(refused.close_code, 4001);
  }
}

TEST_F(WebSocketTest, AnythingButAHelloIsABrokenRule) {
  for (wire::ClientMessage message :
       {wire::ClientMessage(wire::Frame{}), wire::ClientMessage(wire::Finish{}),
        wire::ClientMessage(wire::Ping{}), wire::ClientMessage(wire::Unknown{})}) {
    const Refused refused = first_message(message);
    EXPECT_THAT(refused.error.message, HasSubstr("first message must be a hello"));
    EXPECT_EQ(refused.close_code, 1002);
  }
}

TEST_F(WebSocketTest, GarbageIsNoMessage) {
  const Refused refused = first_message(2, std::string(1000, '\xff'));
  EXPECT_EQ(refused.error.code, "corrupt_data");
  EXPECT_EQ(refused.close_code, 1007);
}

TEST_F(WebSocketTest, TextIsRefused) {
  const Refused refused = first_message(1, "hello");
  EXPECT_THAT(refused.error.message, HasSubstr("binary"));
  EXPECT_EQ(refused.close_code, 1003);
}

TEST_F(WebSocketTest, AFirstMessageAbove64KiBIsTooLarge) {
  const Refused refused = first_message(2, std::string(wire::kMaxBytesBeforeWelcome + 1, 'x'));
  EXPECT_EQ(refused.error.code, "too_large");
  EXPECT_THAT(refused.error.message, HasSubstr("65536"));
  EXPECT_EQ(refused.close_code, 1009);
}

TEST_F(WebSocketTest, AHugeMessageIsRefusedLongBeforeItsEnd) {
  RawClient client(server_.port());
  ASSERT_TRUE(client.upgrade());
  // A header that announces 2^40 bytes, and the first of them.
  client.send(std::string("\x82\xff\0\0\1\0\0\0\0\0\0\0\0\0", 14) + std::string(200'000, 'x'));
  const auto error = client.read<wire::ErrorMessage>();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, "too_large");
}

TEST_F(WebSocketTest, ANoSuchScanIsNotFound) {
  for (const std::string& id : {new_scan_id(), std::string("../../x"), std::string()}) {
    const Refused refused = first_message(viewer_of(id));
    EXPECT_EQ(refused.error.code, "not_found");
    EXPECT_EQ(refused.close_code, 4004);
  }
}

TEST_F(WebSocketTest, ABadSettingOrCameraIsNamed) {
  EXPECT_THAT(first_message(camera_with({{"no.such_setting", "1"}})).error.message,
              HasSubstr("no.such_setting"));
  EXPECT_THAT(first_message(camera_with({{"frame.depth_max_m", "-1"}})).error.message,
              HasSubstr("frame.depth_max_m"));
  wire::Hello hello = camera_with({});
  std::get<wire::StartScan>(hello.role).camera.fx = 0;
  EXPECT_THAT(first_message(hello).error.message, HasSubstr("camera.fx"));
}

TEST_F(WebSocketTest, SilenceIsEndedAfterTenSeconds) {
  RawClient client(server_.port());
  ASSERT_TRUE(client.upgrade());
  const auto start = std::chrono::steady_clock::now();
  EXPECT_FALSE(client.read_message());
  const double waited_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_GT(waited_s, 5);
  EXPECT_LT(waited_s, 20);
}

TEST_F(WebSocketTest, FramesThatBreakTheWebSocketRulesEndTheConnectionOnly) {
  for (const std::string& bytes : {std::string("\x82\x05hello", 7),     // not masked
                                   std::string("\xf2\x80\0\0\0\0", 6),  // reserved bits
                                   std::string("\x83\x80\0\0\0\0", 6),  // unknown opcode
                                   std::string("\x09\x80\0\0\0\0", 6),  // fragmented ping
                                   // A close with half a code.
                                   std::string("\x88\x81\0\0\0\0\x03", 7)}) {
    RawClient client(server_.port());
    ASSERT_TRUE(client.upgrade());
    client.send(bytes);
    EXPECT_FALSE(client.read<wire::Welcome>());
  }
  RawClient client(server_.port());
  EXPECT_TRUE(client.upgrade()) << "the server lives";
}

}  // namespace
}  // namespace hermite::server
