#include "server/service/websocket.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>

#include "proto/wire/messages.h"
#include "server/service/access.h"
#include "server/service/logging.h"
#include "server/service/sessions.h"
#include "server/store/unix_time.h"

namespace hermite {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

constexpr std::chrono::seconds kHelloPatience(10);  // from the request to the end of the first message
constexpr std::chrono::seconds kClosePatience(10);
constexpr std::chrono::seconds kIdleLimit(45);  // without a sign of life; below the 60 s after which proxies cut
constexpr std::chrono::seconds kPingPeriod(15);
constexpr std::chrono::seconds kGrantCheck(2);  // how long a revoked token may still hear something
constexpr std::size_t kReadBytes = 64 * 1024;
constexpr int kClosedByThem = 1006;

// Shared by the reading and the writing half of one connection.
struct Connection {
  websocket::stream<Transport> socket;
  asio::steady_timer something_to_send;
  asio::steady_timer hello_deadline;
  asio::steady_timer grant_check;
  beast::flat_buffer message;
  std::unique_ptr<Session> session;
  Grant grant;  // of the session
  bool reading = true;

  explicit Connection(Transport stream)
      : socket(std::move(stream)),
        something_to_send(socket.get_executor()),
        hello_deadline(socket.get_executor()),
        grant_check(socket.get_executor()) {}

  std::string_view text() const { return {static_cast<const char*>(message.data().data()), message.size()}; }
};

// A whole message into connection.message, at most a little more than `max_bytes()`, which may change while it is awaited. What is wrong
// with it, if the client still can be told.
struct Read {
  error_code error;  // the connection is over
  std::optional<Refusal> wrong;
};

template <class MaxBytes>
asio::awaitable<Read> read_message(Connection& connection, MaxBytes max_bytes) {
  Read read;
  connection.message.consume(connection.message.size());
  // Our own limit instead of Beast's: that one closes without a word about why.
  do {
    co_await connection.socket.async_read_some(connection.message, kReadBytes, asio::redirect_error(asio::use_awaitable, read.error));
    if (read.error) co_return read;
    if (connection.message.size() > max_bytes()) {
      read.wrong = Refusal{{ErrorCode::kTooLarge, "the message is longer than the " + std::to_string(max_bytes()) + " bytes allowed"},
                           CloseCode::kTooBig};
      co_return read;
    }
  } while (!connection.socket.is_message_done());
  if (connection.socket.got_text())
    read.wrong = Refusal{{ErrorCode::kUnsupported, "messages must be binary, this one is text"}, CloseCode::kNotBinary};
  co_return read;
}

asio::awaitable<void> close(Connection& connection, const Closing& closing) {
  websocket::close_reason reason;
  reason.code = static_cast<std::uint16_t>(closing.code);
  // A control frame has room for 123 bytes of words; cut between characters.
  std::size_t length = std::min<std::size_t>(closing.words.size(), 120);
  while (length > 0 && length < closing.words.size() && (static_cast<unsigned char>(closing.words[length]) & 0xC0) == 0x80) --length;
  reason.reason = websocket::reason_string(closing.words.data(), length);
  error_code ignored;
  co_await connection.socket.async_close(reason, asio::redirect_error(asio::use_awaitable, ignored));
}

asio::awaitable<void> write(Connection& connection, const std::string& bytes, error_code& error) {
  co_await connection.socket.async_write(asio::buffer(bytes), asio::redirect_error(asio::use_awaitable, error));
}

asio::awaitable<void> ping(Connection& connection, error_code& error) {
  const websocket::ping_data nothing;
  co_await connection.socket.async_ping(nothing, asio::redirect_error(asio::use_awaitable, error));
}

asio::awaitable<void> write_messages(std::shared_ptr<Connection> connection) {
  error_code error;
  while (!error) {
    if (const SharedBytes message = connection->session->next()) {
      co_await write(*connection, *message, error);
    } else if (const std::optional<Closing> closing = connection->session->closing()) {
      co_await close(*connection, *closing);
      break;
    } else if (!connection->reading) {
      break;
    } else {
      // Whoever has something new cancels the wait; the error that this gives means nothing.
      error_code woken;
      connection->something_to_send.expires_after(kPingPeriod);
      co_await connection->something_to_send.async_wait(asio::redirect_error(asio::use_awaitable, woken));
      if (!woken) co_await ping(*connection, error);
    }
  }
  // The reading half ends with the socket.
  beast::get_lowest_layer(connection->socket).close();
}

asio::awaitable<void> read_messages(Connection& connection) {
  for (;;) {
    const Read read = co_await read_message(connection, [&connection] { return connection.session->max_message_bytes(); });
    if (read.error) co_return;
    if (read.wrong) {
      connection.session->fail(read.wrong->error, read.wrong->code);
      co_return;
    }
    connection.session->receive(connection.text());
  }
}

void set_options(Connection& connection) {
  connection.socket.set_option(websocket::stream_base::timeout{kClosePatience, kIdleLimit, true});
  connection.socket.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
    response.set(beast::http::field::sec_websocket_protocol, wire::kSubprotocol);
    response.set(beast::http::field::server, "hermite");
  }));
  websocket::permessage_deflate off;
  off.server_enable = false;
  connection.socket.set_option(off);
  connection.socket.read_message_max(std::size_t{1} << 40);  // see read_message
  connection.socket.write_buffer_bytes(65536);
  connection.socket.auto_fragment(false);
  connection.socket.binary(true);
}

// Ends the session soon after what was granted has ended. Asks now and then: nobody has to remember who came in with what.
void watch_grant(const std::shared_ptr<Connection>& connection, const Gate& gate) {
  connection->grant_check.expires_after(kGrantCheck);
  connection->grant_check.async_wait([weak = std::weak_ptr(connection), &gate](const error_code& cancelled) {
    const std::shared_ptr<Connection> watched = weak.lock();
    if (cancelled || !watched) return;
    if (gate.holds(watched->grant, unix_now_ms())) return watch_grant(watched, gate);
    watched->session->fail({ErrorCode::kUnauthorized, "the token or share link has expired or was revoked"}, CloseCode::kUnauthorized);
  });
}

// The first message and its answer. A session is there afterwards, or the connection is over.
asio::awaitable<void> begin(const std::shared_ptr<Connection>& connection, const HttpWorld& world, const Peer& peer) {
  connection->hello_deadline.expires_after(kHelloPatience);
  connection->hello_deadline.async_wait([weak = std::weak_ptr(connection)](const error_code& cancelled) {
    const std::shared_ptr<Connection> late = weak.lock();
    if (!cancelled && late && !late->session) beast::get_lowest_layer(late->socket).close();
  });
  Read read = co_await read_message(*connection, [] { return wire::kMaxBytesBeforeWelcome; });
  if (read.error) co_return;
  if (!read.wrong) {
    auto wake = [weak = std::weak_ptr(connection)] {
      if (const std::shared_ptr<Connection> awake = weak.lock()) awake->something_to_send.cancel();
    };
    const auto admit = [&world, &peer](const std::string& secret) {
      Result<Grant> grant = world.gate.admit(secret, {address_group(peer.address), unix_now_ms()});
      if (!grant.ok() && grant.error().code != ErrorCode::kIo) world.metrics.authentication_failed();
      return grant;
    };
    auto greeting = greet(world.scans, admit, connection->text(), std::move(wake));
    if (auto* greeted = std::get_if<Greeted>(&greeting)) {
      connection->session = std::move(greeted->session);
      connection->grant = std::move(greeted->grant);
      log_with({{}, peer.address}, spdlog::level::info, "a connection let in with token " + connection->grant.token_id);
      co_return;
    }
    read.wrong = std::get<Refusal>(std::move(greeting));
  }
  log_with({{}, peer.address}, spdlog::level::info, "connection refused: " + read.wrong->error.message);
  world.metrics.websocket_closed(static_cast<int>(read.wrong->code));
  error_code error;
  const std::string words = format_error(read.wrong->error);
  co_await write(*connection, words, error);
  // A named value: GCC 12 destroys a temporary made of braces twice when it is an argument of co_await.
  const Closing closing{read.wrong->code, read.wrong->error.message};
  if (!error) co_await close(*connection, closing);
}

}  // namespace

bool offers_subprotocol(const beast::http::request<beast::http::empty_body>& upgrade) {
  const beast::http::token_list offered(upgrade[beast::http::field::sec_websocket_protocol]);
  for (const auto name : offered)
    if (name == wire::kSubprotocol) return true;
  return false;
}

asio::awaitable<void> serve_websocket(Transport stream, beast::http::request<beast::http::empty_body> upgrade, const HttpWorld& world,
                                      Peer peer) {
  const auto start = std::chrono::steady_clock::now();
  stream.next_layer().expires_never();
  const auto connection = std::make_shared<Connection>(std::move(stream));
  set_options(*connection);
  error_code error;
  co_await connection->socket.async_accept(upgrade, asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return;
  co_await begin(connection, world, peer);
  connection->hello_deadline.cancel();
  if (!connection->session) co_return;
  watch_grant(connection, world.gate);
  asio::co_spawn(connection->socket.get_executor(), write_messages(connection), asio::detached);
  co_await read_messages(*connection);
  const std::optional<Closing> closing = connection->session->closing();
  const int code = closing ? static_cast<int>(closing->code) : kClosedByThem;
  world.metrics.websocket_closed(code);
  const double duration_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  log_with({{}, peer.address, duration_s}, spdlog::level::debug, "connection closed with code " + std::to_string(code));
  connection->session->disconnected();
  connection->reading = false;
  connection->grant_check.cancel();
  connection->something_to_send.cancel();
}

}  // namespace hermite
