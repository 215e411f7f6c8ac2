// Whole messages over one WebSocket, whatever they say: what the sessions (websocket.h) stand on, and what the Autobahn testsuite is let
// loose on (tests/server/autobahn). One of the places that know Beast. Belongs to the network thread. References outlive what is awaited.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "server/net/transport.h"

namespace hermite {

struct WebSocketTimes {
  std::chrono::seconds close{10};
  std::chrono::seconds idle{45};  // without a sign of life; below the 60 s after which proxies cut
};

struct WebSocketStream {
  boost::beast::websocket::stream<Transport> socket;
  boost::beast::flat_buffer message;  // the last one that was read

  // Without compression; messages of every length are let through, see read_message().
  WebSocketStream(Transport transport, const WebSocketTimes& times);

  std::string_view bytes() const { return {static_cast<const char*>(message.data().data()), message.size()}; }
};

// Answers the upgrade. `subprotocol`: what is said to be spoken, empty: nothing is said.
boost::asio::awaitable<void> accept(WebSocketStream& stream, const boost::beast::http::request<boost::beast::http::empty_body>& upgrade,
                                    const std::string& subprotocol, boost::system::error_code& error);

struct ReadMessage {
  boost::system::error_code error;  // the connection is over, and the other side was told by what RFC 6455 has for it
  bool too_long = false;            // the rest was not read
  bool is_text = false;
};

// A whole message into stream.message. No longer than `max_bytes()`, which may change while it is awaited, and a piece of 64 KiB.
boost::asio::awaitable<ReadMessage> read_message(WebSocketStream& stream, const std::function<std::size_t()>& max_bytes);

boost::asio::awaitable<void> write_message(WebSocketStream& stream, const std::string& bytes, boost::system::error_code& error);
boost::asio::awaitable<void> write_ping(WebSocketStream& stream, boost::system::error_code& error);

// Says goodbye, with as many of the words as there is room for, and waits for theirs.
boost::asio::awaitable<void> close(WebSocketStream& stream, std::uint16_t code, const std::string& words);

}  // namespace hermite
