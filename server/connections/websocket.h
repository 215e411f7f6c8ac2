// One WebSocket connection from the upgrade to the end. One of the places that know Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include "server/net/peer.h"
#include "server/net/transport.h"
#include "server/routes/http_routes.h"

namespace hermite {

// Does the request offer our subprotocol?
bool offers_subprotocol(const boost::beast::http::request<boost::beast::http::empty_body>& upgrade);

// Runs until the connection is over: also when the token that opened it expires or is revoked. Host, Origin and subprotocol were checked.
// `world` outlives it.
boost::asio::awaitable<void> serve_websocket(Transport stream, boost::beast::http::request<boost::beast::http::empty_body> upgrade,
                                             const HttpWorld& world, Peer peer);

}  // namespace hermite
