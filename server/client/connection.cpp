#include "server/client/connection.h"

#include <fmt/core.h>

#include <utility>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include "server/client/client_socket.h"

namespace hermite::client {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using SteadyTime = std::chrono::steady_clock::time_point;

}  // namespace

struct Connection::Impl {
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work = asio::make_work_guard(io);
  ClientSocket socket;
  std::string server;  // for messages

  bool happened = false;  // an event that wait_until() has to return for
  std::optional<Error> ended;
  beast::flat_buffer incoming;
  std::optional<std::string> received;
  std::string outgoing;
  bool writing = false;
  bool closed = false;
  std::uint64_t sent_bytes = 0;

  explicit Impl(server::TlsContext tls)
      : socket(server::Transport(beast::tcp_stream(io), std::move(tls))) {}

  void run_until(SteadyTime deadline) {
    while (!happened && io.run_one_until(deadline) > 0) {
    }
    happened = false;
  }

  void end(const std::string& message, const beast::error_code& error) {
    if (!ended) ended = Error{ErrorCode::kIo, message + ": " + why_ended(socket, error)};
    happened = true;
  }

  void start_reading() {
    socket.async_read(incoming, [this](const beast::error_code& error, std::size_t) {
      if (error) return end(fmt::format("the connection to {} ended", server), error);
      received = beast::buffers_to_string(incoming.data());
      incoming.consume(incoming.size());
      happened = true;
    });
  }

  // A failed write does not end the connection: the server may have sent the reason before it
  // closed, which the pending read receives.
  void start_writing() {
    writing = true;
    socket.async_write(asio::buffer(outgoing), [this](const beast::error_code& error, std::size_t) {
      if (error) return;
      writing = false;
      sent_bytes += outgoing.size();
      happened = true;
    });
  }
};

Connection::Connection(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Connection::~Connection() = default;

Result<std::unique_ptr<Connection>> Connection::open(const ServerUrl& url,
                                                     std::chrono::milliseconds patience,
                                                     const std::string& ca) {
  server::TlsContext tls;
  if (url.tls) {
    Result<server::TlsContext> made = server::client_tls(ca);
    if (!made.ok()) return made.error();
    tls = *std::move(made);
  }
  bool connected = false;
  std::optional<Error> failure;
  // Declared after the objects that its coroutine refers to, so that it is destroyed first.
  auto impl = std::make_unique<Impl>(std::move(tls));
  impl->server = url.host_and_port();
  prepare_socket(impl->socket, patience);
  asio::co_spawn(
      impl->io, connect_socket(impl->socket, url, failure),
      [&connected, raw = impl.get()](std::exception_ptr) { connected = raw->happened = true; });
  impl->run_until(std::chrono::steady_clock::now() + patience);
  if (!connected) {
    return Error{ErrorCode::kIo,
                 fmt::format("{} does not answer within {} ms", impl->server, patience.count())};
  }
  if (failure) return *failure;
  impl->start_reading();
  return std::unique_ptr<Connection>(new Connection(std::move(impl)));
}

bool Connection::can_send() const { return !impl_->writing && !impl_->ended && !impl_->closed; }

void Connection::send(std::string message) {
  CHECK(can_send(), "one message at a time");
  impl_->outgoing = std::move(message);
  impl_->start_writing();
}

std::uint64_t Connection::sent_bytes() const { return impl_->sent_bytes; }

std::optional<std::string> Connection::take_message() {
  if (!impl_->received) return std::nullopt;
  auto message = std::exchange(impl_->received, std::nullopt);
  if (!impl_->ended && !impl_->closed) impl_->start_reading();
  return message;
}

void Connection::wait_until(std::chrono::steady_clock::time_point deadline) {
  if (impl_->ended || impl_->received) return;
  impl_->run_until(deadline);
}

void Connection::wake() {
  asio::post(impl_->io, [impl = impl_.get()] { impl->happened = true; });
}

const std::optional<Error>& Connection::ended() const { return impl_->ended; }

void Connection::close(std::chrono::milliseconds patience) {
  if (impl_->ended || impl_->closed) return;
  impl_->closed = true;
  bool done = false;
  impl_->socket.async_close(websocket::close_code::normal,
                            [&](const beast::error_code&) { done = impl_->happened = true; });
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!done && std::chrono::steady_clock::now() < deadline) impl_->run_until(deadline);
  if (!done) beast::get_lowest_layer(impl_->socket).close();
  impl_->io.poll();
}

}  // namespace hermite::client
