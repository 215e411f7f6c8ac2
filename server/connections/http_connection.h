// One TCP connection, with or without TLS: serves HTTP requests one after another, until one of
// them becomes a WebSocket. One of the files that use Boost.Beast.
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

namespace hermite::server {

inline constexpr std::size_t kMaxHeaderBytes = 8 * 1024;
// Body of a POST; other requests have none, except those of takes_long_body().
inline constexpr std::size_t kMaxBodyBytes = 4 * 1024;

// The handler behind a listening port, and the checks that every request must pass before it is
// routed.
struct Site {
  std::function<HttpAnswer(const HttpRequest&)> answer;
  AllowedHosts hosts;
  Metrics& metrics;
  const HttpWorld* websockets = nullptr;  // nullptr: WebSockets are not accepted
  // Networks of the proxies whose X-Forwarded- headers are trusted.
  std::vector<Network> proxies = {};
  // Refuse requests that are neither from this machine nor encrypted, whether by TLS here or up to
  // a trusted proxy.
  bool encrypted_only = false;
  RateLimit* requests = nullptr;  // rate limit per address; nullptr: unlimited
  // Where long bodies are written and read; nullptr: they are not supported.
  boost::asio::thread_pool* disk = nullptr;
};

// Runs until the connection has ended. A request that violates a rule is answered and the
// connection closed, so that nothing that follows it can be mistaken for another request. `address`
// is that of the other end; rate limits apply to the client behind it (address_group). Without
// `tls` the connection is not encrypted. `site` outlives it.
boost::asio::awaitable<void> serve_connection(boost::asio::ip::tcp::socket socket,
                                              std::string address, TlsContext tls,
                                              const Site& site);

// Refuses a connection beyond the limit: sends `answer` without having read a request. Takes at
// most seven seconds, apart from sending the answer.
boost::asio::awaitable<void> refuse_connection(boost::asio::ip::tcp::socket socket, TlsContext tls,
                                               HttpAnswer answer);

}  // namespace hermite::server
