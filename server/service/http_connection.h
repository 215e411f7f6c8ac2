// One TCP connection: HTTP requests one after the other, until one of them becomes a WebSocket. One of the three places that know Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "server/service/access.h"
#include "server/service/http_routes.h"

namespace hermite {

inline constexpr std::size_t kMaxHeaderBytes = 8 * 1024;

// Runs until the connection is over. Requests carry no bodies; one that breaks a rule is answered and the connection closed, so that
// nothing behind it can be taken for another request. `world` and `hosts` outlive it.
boost::asio::awaitable<void> serve_connection(boost::asio::ip::tcp::socket socket, const HttpWorld& world, const AllowedHosts& hosts);

}  // namespace hermite
