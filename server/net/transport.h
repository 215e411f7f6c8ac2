// A TCP connection with or without TLS as a single type, so that the code for HTTP and WebSocket
// exists only once. Meets Beast's AsyncStream and its requirements for teardown;
// beast::get_lowest_layer() returns the tcp_stream with its timeouts. One of the files that use
// Boost.Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/ssl/stream_base.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <memory>
#include <variant>

#include "server/net/tls.h"

#ifndef BOOST_DISABLE_ASSERTS
#error \
    "Link hermite_net: one of Boost's assertions is wrong and ends the server" \
    "(server/CMakeLists.txt)."
#endif

namespace hermite::server {

class Transport {
 public:
  using Tcp = boost::beast::tcp_stream;
  using Tls = boost::beast::ssl_stream<Tcp>;
  using next_layer_type = Tcp;
  using executor_type = Tcp::executor_type;

  // Without `tls` the connection is not encrypted.
  Transport(Tcp tcp, TlsContext tls) : context_(std::move(tls)) {
    if (context_)
      stream_ = std::make_unique<Tls>(std::move(tcp), *context_);
    else
      stream_ = std::make_unique<Tcp>(std::move(tcp));
  }

  Tls* tls() {
    return std::holds_alternative<TlsPointer>(stream_) ? std::get<TlsPointer>(stream_).get()
                                                       : nullptr;
  }
  bool encrypted() const { return std::holds_alternative<TlsPointer>(stream_); }
  Tcp& next_layer() { return encrypted() ? tls()->next_layer() : *std::get<TcpPointer>(stream_); }
  const Tcp& next_layer() const { return const_cast<Transport*>(this)->next_layer(); }
  executor_type get_executor() { return next_layer().get_executor(); }

  template <class Buffers, class Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return encrypted() ? tls()->async_read_some(buffers, std::forward<Token>(token))
                       : next_layer().async_read_some(buffers, std::forward<Token>(token));
  }
  template <class Buffers, class Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return encrypted() ? tls()->async_write_some(buffers, std::forward<Token>(token))
                       : next_layer().async_write_some(buffers, std::forward<Token>(token));
  }

 private:
  using TcpPointer = std::unique_ptr<Tcp>;
  using TlsPointer = std::unique_ptr<Tls>;
  TlsContext context_;  // keeps alive the context, to which the stream has only a reference
  std::variant<TcpPointer, TlsPointer> stream_;
};

// Called by Beast's WebSockets when a connection ends.
inline void teardown(boost::beast::role_type role, Transport& transport,
                     boost::system::error_code& error) {
  using boost::beast::websocket::teardown;
  if (transport.tls())
    teardown(role, *transport.tls(), error);
  else
    teardown(role, transport.next_layer().socket(), error);
}
template <class Handler>
void async_teardown(boost::beast::role_type role, Transport& transport, Handler&& handler) {
  using boost::beast::websocket::async_teardown;
  if (transport.tls())
    async_teardown(role, *transport.tls(), std::forward<Handler>(handler));
  else
    async_teardown(role, transport.next_layer(), std::forward<Handler>(handler));
}

}  // namespace hermite::server
