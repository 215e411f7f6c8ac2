// One WebSocket connection from the upgrade to its end. One of the files that use Boost.Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include "server/net/peer.h"
#include "server/net/transport.h"
#include "server/routes/http_routes.h"

namespace hermite::server {

// Returns whether the request offers the subprotocol of Hermite.
bool offers_subprotocol(const boost::beast::http::request<boost::beast::http::empty_body>& upgrade);

// Runs until the connection has ended, which includes that its token expires or is revoked. The
// caller has checked Host, Origin and subprotocol. `world` outlives it.
boost::asio::awaitable<void> serve_websocket(
    Transport stream, boost::beast::http::request<boost::beast::http::empty_body> upgrade,
    const HttpWorld& world, Peer peer);

}  // namespace hermite::server
