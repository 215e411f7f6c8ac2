// One WebSocket connection from the upgrade to the end. One of the three places that know Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <string>

#include "server/service/scans.h"

namespace hermite {

// Does the request offer our subprotocol?
bool offers_subprotocol(const boost::beast::http::request<boost::beast::http::empty_body>& upgrade);

// Runs until the connection is over. Host, Origin and subprotocol were checked. `scans` and `token` outlive it.
boost::asio::awaitable<void> serve_websocket(boost::beast::tcp_stream stream,
                                             boost::beast::http::request<boost::beast::http::empty_body> upgrade, Scans& scans,
                                             const std::string& token);

}  // namespace hermite
