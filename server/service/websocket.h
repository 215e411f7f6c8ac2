// One WebSocket connection from the upgrade to the end. One of the three places that know Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <string>

#include "server/service/gate.h"
#include "server/service/scans.h"

namespace hermite {

// Does the request offer our subprotocol?
bool offers_subprotocol(const boost::beast::http::request<boost::beast::http::empty_body>& upgrade);

struct WebSocketWorld {
  Scans& scans;
  Gate& gate;
  std::string address;  // of the client, as the gate counts it
};

// Runs until the connection is over: also when the token that opened it expires or is revoked. Host, Origin and subprotocol were checked.
// What `world` refers to outlives it.
boost::asio::awaitable<void> serve_websocket(boost::beast::tcp_stream stream,
                                             boost::beast::http::request<boost::beast::http::empty_body> upgrade, WebSocketWorld world);

}  // namespace hermite
