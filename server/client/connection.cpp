#include "server/client/connection.h"

#include <utility>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "proto/wire/messages.h"
#include "server/net/transport.h"

namespace hermite {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Socket = websocket::stream<Transport>;
using SteadyTime = std::chrono::steady_clock::time_point;

// A server that answers no ping for this long is considered dead. Pings are sent at half this interval, which also
// keeps proxies from closing the connection (60 s).
constexpr std::chrono::seconds kSilence(45);
// Halves the cost of a write compared to Beast's 4 KiB.
constexpr std::size_t kWriteBuffer_bytes = 65536;

void prepare(Socket& socket, std::chrono::milliseconds patience) {
  websocket::stream_base::timeout timeouts{};
  timeouts.handshake_timeout = patience;
  timeouts.idle_timeout = kSilence;
  timeouts.keep_alive_pings = true;
  socket.set_option(timeouts);
  socket.set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
    request.set(http::field::sec_websocket_protocol, wire::kSubprotocol);
    request.set(http::field::user_agent, "hermite-client");
  }));
  socket.binary(true);
  socket.auto_fragment(false);
  socket.write_buffer_bytes(kWriteBuffer_bytes);
  socket.read_message_max(wire::kMaxServerMessageBytes);
}

Error refusal(const std::string& server, const websocket::response_type& response, const beast::error_code& error) {
  if (error != websocket::error::upgrade_declined) {
    return {ErrorCode::kIo, "the WebSocket handshake with " + server + " failed: " + error.message()};
  }
  const unsigned status = response.result_int();
  const std::string answer = "HTTP " + std::to_string(status) + " " + std::string(response.reason());
  if (status == 401 || status == 403) return {ErrorCode::kUnauthorized, server + " refuses the connection: " + answer};
  if (status == 429 || status == 503) return {ErrorCode::kBusy, server + " is busy: " + answer};
  return {ErrorCode::kUnsupported, server + " is no Hermite server: it answers " + answer};
}

// Returns what is wrong with the server's certificate, as text.
Error distrust(const std::string& server, const beast::error_code& error, Transport::Tls& tls) {
  const long verdict = SSL_get_verify_result(tls.native_handle());
  if (verdict == X509_V_OK) return {ErrorCode::kIo, "TLS with " + server + " failed: " + error.message()};
  return {ErrorCode::kUnauthorized, "the certificate of " + server + " is not trusted: " + X509_verify_cert_error_string(verdict) +
                                        " (--ca names a file with the authorities to trust)"};
}

// Performs the TLS handshake, accepting only the server that `url` names.
asio::awaitable<void> shake_hands(Transport::Tls& tls, const ServerUrl& url, std::optional<Error>& failure) {
  beast::error_code error;
  asio::ip::make_address(url.host, error);
  const bool is_name = static_cast<bool>(error);
  // The server name indication (SNI) must not contain an address.
  if (is_name) SSL_set_tlsext_host_name(tls.native_handle(), url.host.c_str());
  tls.set_verify_callback(asio::ssl::host_name_verification(url.host));
  co_await tls.async_handshake(asio::ssl::stream_base::client, asio::redirect_error(asio::use_awaitable, error));
  if (error) failure = distrust(url.host_and_port(), error, tls);
}

// Resolves the name, connects and upgrades to WebSocket. Sets `failure` unless that succeeded.
asio::awaitable<void> connect(Socket& socket, const ServerUrl& url, std::optional<Error>& failure) {
  const std::string server = url.host_and_port();
  beast::error_code error;
  const auto then = [&error] { return asio::redirect_error(asio::use_awaitable, error); };
  tcp::resolver resolver(socket.get_executor());
  const auto addresses = co_await resolver.async_resolve(url.host, std::to_string(url.port), then());
  if (error) {
    failure = Error{ErrorCode::kIo, "cannot find " + server + ": " + error.message()};
    co_return;
  }
  co_await beast::get_lowest_layer(socket).async_connect(addresses, then());
  if (error) {
    failure = Error{ErrorCode::kIo, "cannot connect to " + server + ": " + error.message()};
    co_return;
  }
  beast::get_lowest_layer(socket).socket().set_option(tcp::no_delay(true));
  if (socket.next_layer().tls()) co_await shake_hands(*socket.next_layer().tls(), url, failure);
  if (failure) co_return;
  websocket::response_type response;
  co_await socket.async_handshake(response, server, wire::kEndpoint, then());
  if (error) {
    failure = refusal(server, response, error);
    co_return;
  }
  if (response[http::field::sec_websocket_protocol] != wire::kSubprotocol) {
    failure = Error{ErrorCode::kUnsupported, server + " does not speak the protocol " + wire::kSubprotocol};
  }
}

}  // namespace

struct Connection::Impl {
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work = asio::make_work_guard(io);
  Socket socket;
  std::string server;  // for messages

  bool happened = false;  // an event that wait_until() has to return for
  std::optional<Error> ended;
  beast::flat_buffer incoming;
  std::optional<std::string> received;
  std::string outgoing;
  bool writing = false;
  bool closed = false;
  std::uint64_t sent_bytes = 0;

  explicit Impl(TlsContext tls) : socket(Transport(beast::tcp_stream(io), std::move(tls))) {}

  void run_until(SteadyTime deadline) {
    while (!happened && io.run_one_until(deadline) > 0) {
    }
    happened = false;
  }

  void end(const std::string& message, const beast::error_code& error) {
    if (!ended) ended = Error{ErrorCode::kIo, message + ": " + explain(error)};
    happened = true;
  }

  std::string explain(const beast::error_code& error) const {
    if (error == websocket::error::closed) {
      const auto& reason = socket.reason();
      return "the server closed it (code " + std::to_string(reason.code) + (reason.reason.empty() ? "" : ", ") +
             std::string(reason.reason.data(), reason.reason.size()) + ")";
    }
    if (error == beast::error::timeout) return "no sign of life for " + std::to_string(kSilence.count()) + " s";
    return error.message();
  }

  void start_reading() {
    socket.async_read(incoming, [this](const beast::error_code& error, std::size_t) {
      if (error) return end("the connection to " + server + " ended", error);
      received = beast::buffers_to_string(incoming.data());
      incoming.consume(incoming.size());
      happened = true;
    });
  }

  // A failed write does not end the connection: the server may have sent the reason before it closed, which the pending
  // read receives.
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

Result<std::unique_ptr<Connection>> Connection::open(const ServerUrl& url, std::chrono::milliseconds patience, const std::string& ca) {
  TlsContext tls;
  if (url.tls) {
    Result<TlsContext> made = client_tls(ca);
    if (!made.ok()) return made.error();
    tls = *std::move(made);
  }
  bool connected = false;
  std::optional<Error> failure;
  // Declared after the objects that its coroutine refers to, so that it is destroyed first.
  auto impl = std::make_unique<Impl>(std::move(tls));
  impl->server = url.host_and_port();
  prepare(impl->socket, patience);
  asio::co_spawn(impl->io, connect(impl->socket, url, failure),
                 [&connected, raw = impl.get()](std::exception_ptr) { connected = raw->happened = true; });
  impl->run_until(std::chrono::steady_clock::now() + patience);
  if (!connected) {
    return Error{ErrorCode::kIo, impl->server + " does not answer within " + std::to_string(patience.count()) + " ms"};
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
  impl_->socket.async_close(websocket::close_code::normal, [&](const beast::error_code&) { done = impl_->happened = true; });
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!done && std::chrono::steady_clock::now() < deadline) impl_->run_until(deadline);
  if (!done) beast::get_lowest_layer(impl_->socket).close();
  impl_->io.poll();
}

}  // namespace hermite
