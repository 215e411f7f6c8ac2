// Accepts the connections of the listening ports, each up to its limit, and refuses the others with
// an answer. On the network thread.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <string>

#include "server/access/rate_limit.h"
#include "server/connections/http_connection.h"
#include "server/net/tls.h"

namespace hermite::server {

class ConnectionAcceptor {
 public:
  // A port's handler, and its limit on connections. Holds only references, so it may be copied.
  struct Port {
    const Site& site;
    CountLimit& connections;
    bool encrypted;  // if there is a certificate
  };

  // `tls` is what new connections get, and may change; nullptr: not encrypted. It and this outlive
  // the event loop with its connections.
  explicit ConnectionAcceptor(const TlsContext& tls) : tls_(tls) {}

  // Runs until `open` is closed.
  boost::asio::awaitable<void> accept(boost::asio::ip::tcp::acceptor& open, Port port);

 private:
  // Serves it on its own, or refuses it.
  void take(boost::asio::ip::tcp::socket socket, const Port& port);
  // `counted`: what it counts as for the limit, of which it has taken a place.
  boost::asio::awaitable<void> serve(boost::asio::ip::tcp::socket socket, std::string address,
                                     std::string counted, Port port);
  boost::asio::awaitable<void> refuse(boost::asio::ip::tcp::socket socket, bool encrypted);

  const TlsContext& tls_;
  int refusing_count_ = 0;
};

}  // namespace hermite::server
