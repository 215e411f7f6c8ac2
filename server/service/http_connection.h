// One TCP connection: HTTP requests one after the other, until one of them becomes a WebSocket. One of the three places that know Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <string>

#include "server/service/access.h"
#include "server/service/http_routes.h"
#include "server/service/rate_limit.h"

namespace hermite {

inline constexpr std::size_t kMaxHeaderBytes = 8 * 1024;
inline constexpr std::size_t kMaxBodyBytes = 4 * 1024;  // of a POST; other requests carry none

// What every request is held to before anybody asks what it wants.
struct RequestRules {
  const AllowedHosts& hosts;
  RateLimit& requests;
};

// Runs until the connection is over. A request that breaks a rule is answered and the connection closed, so that nothing behind it can be
// taken for another request. `address` is whose allowance is used up (address_group). `world` and what `rules` refers to outlive it.
boost::asio::awaitable<void> serve_connection(boost::asio::ip::tcp::socket socket, std::string address, const HttpWorld& world,
                                              RequestRules rules);

// For one connection too many: gives that answer without having read a request. A second and a half at most.
boost::asio::awaitable<void> refuse_connection(boost::asio::ip::tcp::socket socket, HttpAnswer answer);

}  // namespace hermite
