// Sends and receives whole messages over a WebSocket, whatever their contents. The sessions
// (websocket.h) are built on it, and the Autobahn test suite tests it (tests/server/autobahn). One
// of the files that use Boost.Beast. Belongs to the network thread. Objects passed by reference
// outlive the awaited operation.
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

namespace hermite::server {

struct WebSocketTimes {
  std::chrono::seconds close{10};
  // Time without any traffic; below the 60 s after which proxies close a connection.
  std::chrono::seconds idle{45};
};

struct WebSocketStream {
  boost::beast::websocket::stream<Transport> socket;
  boost::beast::flat_buffer message;  // the last message that was read

  // Disables compression. Accepts messages of any length; read_message() limits them.
  WebSocketStream(Transport transport, const WebSocketTimes& times);

  std::string_view bytes() const {
    return {static_cast<const char*>(message.data().data()), message.size()};
  }
};

// Accepts the upgrade. `subprotocol` is the one that the response names; empty: none.
boost::asio::awaitable<void> accept(
    WebSocketStream& stream,
    const boost::beast::http::request<boost::beast::http::empty_body>& upgrade,
    const std::string& subprotocol, boost::system::error_code& error);

struct ReadMessage {
  // The connection has ended, and the other side was told as RFC 6455 requires.
  boost::system::error_code error;
  bool too_long = false;  // the rest was not read
  bool is_text = false;
};

// Reads a whole message into stream.message. Stops once it is longer than `max_bytes()`, so that it
// exceeds that by at most one piece of 64 KiB. `max_bytes()` may change meanwhile.
boost::asio::awaitable<ReadMessage> read_message(WebSocketStream& stream,
                                                 const std::function<std::size_t()>& max_bytes);

boost::asio::awaitable<void> write_message(WebSocketStream& stream, const std::string& bytes,
                                           boost::system::error_code& error);
boost::asio::awaitable<void> write_ping(WebSocketStream& stream, boost::system::error_code& error);

// Sends a close frame, whose reason is `text` truncated to what fits, and waits for the close frame
// of the other side.
boost::asio::awaitable<void> close(WebSocketStream& stream, std::uint16_t code,
                                   const std::string& text);

}  // namespace hermite::server
