#include "server/client/connection.h"

#include <functional>
#include <string>
#include <thread>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include "proto/wire/messages.h"

namespace hermite::client {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using std::chrono::milliseconds;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;
using PeerSocket = websocket::stream<tcp::socket>;

constexpr milliseconds kPatience(20'000);  // never reached by a passing test

// Something on a local port that is not Hermite's server: accepts one connection and does with it
// what the test says.
class Peer {
 public:
  explicit Peer(std::function<void(tcp::socket&)> behaviour)
      : thread_([this, behaviour = std::move(behaviour)] {
          tcp::socket socket(io_);
          beast::error_code error;
          acceptor_.accept(socket, error);
          if (!error) behaviour(socket);
        }) {}
  ~Peer() {
    beast::error_code ignored;
    tcp::socket(io_).connect(acceptor_.local_endpoint(), ignored);  // in case that nobody came
    thread_.join();
  }
  ServerUrl url() const { return {"127.0.0.1", acceptor_.local_endpoint().port(), "token"}; }

 private:
  asio::io_context io_;
  tcp::acceptor acceptor_{io_, {asio::ip::address_v4::loopback(), 0}};
  std::thread thread_;
};

// A peer that completes the handshake, naming `subprotocol`, before it does what the test says.
Peer web_socket_peer(const std::string& subprotocol, std::function<void(PeerSocket&)> behaviour) {
  return Peer([=](tcp::socket& socket) {
    PeerSocket stream(std::move(socket));
    stream.set_option(websocket::stream_base::decorator([&](websocket::response_type& response) {
      response.set(beast::http::field::sec_websocket_protocol, subprotocol);
    }));
    beast::error_code error;
    stream.accept(error);
    stream.binary(true);
    if (!error) behaviour(stream);
  });
}

Peer http_peer(const std::string& answer) {
  return Peer([=](tcp::socket& socket) {
    beast::error_code ignored;
    std::string request;
    asio::read_until(socket, asio::dynamic_buffer(request), "\r\n\r\n", ignored);
    asio::write(socket, asio::buffer(answer), ignored);
  });
}

void echo(PeerSocket& stream) {
  beast::error_code error;
  stream.read_message_max(0);
  while (!error) {
    beast::flat_buffer buffer;
    stream.read(buffer, error);
    if (!error) stream.write(buffer.data(), error);
  }
}

std::optional<std::string> next_message(Connection& connection) {
  const auto deadline = Clock::now() + kPatience;
  while (Clock::now() < deadline) {
    if (auto message = connection.take_message()) return message;
    if (connection.ended()) return std::nullopt;
    connection.wait_until(deadline);
  }
  return std::nullopt;
}

TEST(Connection, NobodyListeningIsSaidWithTheAddress) {
  asio::io_context io;
  tcp::acceptor taken(io, {asio::ip::address_v4::loopback(), 0});
  const ServerUrl url{"127.0.0.1", taken.local_endpoint().port(), ""};
  taken.close();
  const auto connection = Connection::open(url, kPatience);
  ASSERT_FALSE(connection.ok());
  EXPECT_EQ(connection.error().code, ErrorCode::kIo);
  EXPECT_THAT(connection.error().message, HasSubstr("cannot connect to " + url.host_and_port()));
}

TEST(Connection, AServerThatIsSilentDoesNotHoldUsForever) {
  const Peer peer([](tcp::socket& socket) {
    beast::error_code ignored;
    std::string never_enough;
    asio::read(socket, asio::dynamic_buffer(never_enough), ignored);  // until the client goes
  });
  const auto start = Clock::now();
  const auto connection = Connection::open(peer.url(), milliseconds(200));
  ASSERT_FALSE(connection.ok());
  EXPECT_EQ(connection.error().code, ErrorCode::kIo);
  EXPECT_LT(Clock::now() - start, kPatience);
}

TEST(Connection, AWebServerThatIsNotHermiteIsNamedAsSuch) {
  const Peer peer = http_peer("HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n");
  const auto connection = Connection::open(peer.url(), kPatience);
  ASSERT_FALSE(connection.ok());
  EXPECT_EQ(connection.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(connection.error().message, HasSubstr("404 Not Found"));
}

TEST(Connection, ARefusalIsUnauthorized) {
  const Peer peer = http_peer("HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\n\r\n");
  EXPECT_EQ(Connection::open(peer.url(), kPatience).error().code, ErrorCode::kUnauthorized);
}

TEST(Connection, SomethingThatSpeaksNoHttpFailsWithAMessage) {
  const Peer peer = http_peer("SSH-2.0-OpenSSH_9.2\r\n\r\n");
  const auto connection = Connection::open(peer.url(), kPatience);
  ASSERT_FALSE(connection.ok());
  EXPECT_THAT(connection.error().message, HasSubstr("handshake"));
}

TEST(Connection, AnotherSubprotocolIsRefused) {
  const Peer peer = web_socket_peer("other.v1", echo);
  const auto connection = Connection::open(peer.url(), kPatience);
  ASSERT_FALSE(connection.ok());
  EXPECT_EQ(connection.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(connection.error().message, HasSubstr(wire::kSubprotocol));
}

TEST(Connection, MessagesComeBackWholeAndInOrder) {
  const Peer peer = web_socket_peer(wire::kSubprotocol, echo);
  auto connection = Connection::open(peer.url(), kPatience);
  ASSERT_TRUE(connection.ok()) << connection.error().message;
  std::uint64_t sent_bytes = 0;
  for (const std::size_t size : {1u, 70'000u, 3'000'000u, 0u, 5u}) {
    const std::string message(size, static_cast<char>('a' + size % 7));
    while (!(*connection)->can_send()) (*connection)->wait_until(Clock::now() + kPatience);
    (*connection)->send(message);
    const auto answer = next_message(**connection);
    ASSERT_TRUE(answer);
    EXPECT_EQ(*answer, message);
    sent_bytes += size;
  }
  EXPECT_EQ((*connection)->sent_bytes(), sent_bytes);
  (*connection)->close(kPatience);
  EXPECT_FALSE((*connection)->can_send());
}

TEST(Connection, ALongWriteDoesNotKeepMessagesFromComingIn) {
  // The peer reads nothing until its own message has been taken.
  const Peer peer = web_socket_peer(wire::kSubprotocol, [](PeerSocket& stream) {
    beast::error_code error;
    stream.read_message_max(0);
    stream.write(asio::buffer(std::string(8'000'000, 'x')), error);
    echo(stream);
  });
  auto connection = Connection::open(peer.url(), kPatience);
  ASSERT_TRUE(connection.ok());
  (*connection)->send(std::string(32'000'000, 'y'));
  const auto first = next_message(**connection);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->size(), 8'000'000u);
}

TEST(Connection, WhatTheServerSaidBeforeItClosedCanStillBeRead) {
  const Peer peer = web_socket_peer(wire::kSubprotocol, [](PeerSocket& stream) {
    beast::error_code error;
    stream.write(asio::buffer(std::string("last words")), error);
    stream.close({websocket::close_code::policy_error, "wrong token"}, error);
  });
  auto connection = Connection::open(peer.url(), kPatience);
  ASSERT_TRUE(connection.ok());
  EXPECT_EQ(next_message(**connection), "last words");
  EXPECT_EQ(next_message(**connection), std::nullopt);
  ASSERT_TRUE((*connection)->ended());
  EXPECT_THAT((*connection)->ended()->message, HasSubstr("1008, wrong token"));
  EXPECT_FALSE((*connection)->can_send());
}

TEST(Connection, AMessageBeyondTheLimitEndsIt) {
  const Peer peer = web_socket_peer(wire::kSubprotocol, [](PeerSocket& stream) {
    beast::error_code error;
    stream.write(asio::buffer(std::string(wire::kMaxServerMessageBytes + 1, 'x')), error);
    echo(stream);
  });
  auto connection = Connection::open(peer.url(), kPatience);
  ASSERT_TRUE(connection.ok());
  EXPECT_EQ(next_message(**connection), std::nullopt);
  EXPECT_TRUE((*connection)->ended());
}

TEST(Connection, AnotherThreadCanWakeAWait) {
  const Peer peer = web_socket_peer(wire::kSubprotocol, echo);
  auto connection = Connection::open(peer.url(), kPatience);
  ASSERT_TRUE(connection.ok());
  const auto start = Clock::now();
  std::thread waker([&] { (*connection)->wake(); });
  (*connection)->wait_until(start + kPatience);
  EXPECT_LT(Clock::now() - start, kPatience);
  waker.join();
}

}  // namespace
}  // namespace hermite::client
