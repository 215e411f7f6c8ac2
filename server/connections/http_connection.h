// One TCP connection, with or without TLS: HTTP requests one after the other, until one of them becomes a WebSocket. One of the places that
// know Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <string>
#include <vector>

#include "server/access/access.h"
#include "server/access/rate_limit.h"
#include "server/net/peer.h"
#include "server/net/tls.h"
#include "server/operations/metrics.h"
#include "server/routes/http_routes.h"

namespace hermite {

inline constexpr std::size_t kMaxHeaderBytes = 8 * 1024;
inline constexpr std::size_t kMaxBodyBytes = 4 * 1024;  // of a POST; other requests carry none, but those of takes_long_body()

// What answers behind a listening port, and what every request is held to before anybody asks what it wants.
struct Site {
  std::function<HttpAnswer(const HttpRequest&)> answer;
  AllowedHosts hosts;
  Metrics& metrics;
  const HttpWorld* websockets = nullptr;  // none: no WebSockets here
  std::vector<Network> proxies = {};      // whose X-Forwarded- headers are believed
  // Requests that came neither from this machine nor encrypted, by TLS here or up to a trusted proxy, are refused.
  bool encrypted_only = false;
  RateLimit* requests = nullptr;             // of each address; none: as many as come
  boost::asio::thread_pool* disk = nullptr;  // where long bodies are written and read; none: there are none here
};

// Runs until the connection is over. A request that breaks a rule is answered and the connection closed, so that nothing behind it can be
// taken for another request. `address` is the other end's; allowances are those of the peer that it speaks for (address_group). Without
// `tls` nothing is encrypted. `site` outlives it.
boost::asio::awaitable<void> serve_connection(boost::asio::ip::tcp::socket socket, std::string address, TlsContext tls, const Site& site);

// For one connection too many: gives that answer without having read a request. Seven seconds at most.
boost::asio::awaitable<void> refuse_connection(boost::asio::ip::tcp::socket socket, TlsContext tls, HttpAnswer answer);

}  // namespace hermite
