#include "server/service/connection_acceptor.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <cstdint>

#include "server/operations/logging.h"

namespace hermite::server {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

// Refused connections that are answered at once; further ones are only closed.
constexpr int kMaxRefusing = 32;
constexpr std::int64_t kRefusedRetry_ms = 5000;

}  // namespace

asio::awaitable<void> ConnectionAcceptor::serve(tcp::socket socket, std::string address,
                                                std::string counted, Port port) {
  // Released however the connection ends: a place that is never released would eventually lock
  // everybody out.
  struct Place {
    CountLimit& connections;
    const std::string& counted;
    ~Place() { connections.leave(counted); }
  } const place{port.connections, counted};
  // A named variable, see websocket.cpp.
  TlsContext context_of_now = port.encrypted ? tls_ : nullptr;
  co_await serve_connection(std::move(socket), std::move(address), std::move(context_of_now),
                            port.site);
}

asio::awaitable<void> ConnectionAcceptor::refuse(tcp::socket socket, bool encrypted) {
  ++refusing_count_;
  TlsContext context_of_now = encrypted ? tls_ : nullptr;
  HttpAnswer answer = wait_answer(503, "too many connections are open", kRefusedRetry_ms);
  co_await refuse_connection(std::move(socket), std::move(context_of_now), std::move(answer));
  --refusing_count_;
}

void ConnectionAcceptor::take(tcp::socket socket, const Port& port) {
  const asio::any_io_executor executor = socket.get_executor();
  error_code error;
  const tcp::endpoint other_end = socket.remote_endpoint(error);
  if (error) return;  // closed already
  std::string address = other_end.address().to_string();
  // All clients of a proxy have its address.
  std::string counted =
      lies_in_any(port.site.proxies, address) ? std::string() : address_group(address);
  if (port.connections.enter(counted)) {
    asio::co_spawn(executor, serve(std::move(socket), std::move(address), std::move(counted), port),
                   asio::detached);
  } else if (refusing_count_ < kMaxRefusing) {
    log_with({{}, address}, spdlog::level::warn,
             fmt::format("refused a connection: {} are open", port.connections.count()));
    asio::co_spawn(executor, refuse(std::move(socket), port.encrypted), asio::detached);
  }
}

asio::awaitable<void> ConnectionAcceptor::accept(tcp::acceptor& open, Port port) {
  while (open.is_open()) {
    error_code error;
    tcp::socket socket =
        co_await open.async_accept(asio::redirect_error(asio::use_awaitable, error));
    if (error == asio::error::operation_aborted) co_return;
    if (error) {
      // Most likely out of file descriptors: other connections have to end first.
      spdlog::warn("accepting a connection: {}", error.message());
      asio::steady_timer pause(open.get_executor(), std::chrono::milliseconds(100));
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
    } else {
      take(std::move(socket), port);
    }
  }
}

}  // namespace hermite::server
