#include "server/connections/websocket.h"

#include <fmt/core.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>

#include "proto/wire/messages.h"
#include "server/access/access.h"
#include "server/connections/sessions.h"
#include "server/connections/websocket_stream.h"
#include "server/operations/logging.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using boost::system::error_code;

// Time from the request to the end of the first message.
constexpr std::chrono::seconds kHelloPatience(10);
constexpr std::chrono::seconds kPingPeriod(15);
// How long a revoked token may still receive messages.
constexpr std::chrono::seconds kGrantCheck(2);
constexpr int kClosedByThem = 1006;

// Shared by the reading and the writing coroutine of a connection.
struct Connection {
  WebSocketStream stream;
  asio::steady_timer something_to_send;
  asio::steady_timer hello_deadline;
  asio::steady_timer grant_check;
  std::unique_ptr<Session> session;
  Grant grant;  // of the session
  // The connection's place in the share of its token, held until the connection ends.
  std::unique_ptr<ShareCount::Place> tokens_place;
  // What the audit log last recorded for the session.
  std::string noted;
  bool reading = true;

  explicit Connection(Transport transport)
      : stream(std::move(transport), WebSocketTimes{}),
        something_to_send(stream.socket.get_executor()),
        hello_deadline(stream.socket.get_executor()),
        grant_check(stream.socket.get_executor()) {}
};

// Returns what is wrong with a message, as far as the client can still be told.
std::optional<Refusal> objection_to(const ReadMessage& read, std::size_t max_bytes) {
  if (read.too_long)
    return Refusal{{ErrorCode::kTooLarge,
                    fmt::format("the message is longer than the {} bytes allowed", max_bytes)},
                   CloseCode::kTooBig};
  if (read.is_text)
    return Refusal{{ErrorCode::kUnsupported, "messages must be binary, this one is text"},
                   CloseCode::kNotBinary};
  return std::nullopt;
}

asio::awaitable<void> close(Connection& connection, const Closing& closing) {
  co_await close(connection.stream, static_cast<std::uint16_t>(closing.code), closing.reason);
}

asio::awaitable<void> write_messages(std::shared_ptr<Connection> connection) {
  error_code error;
  while (!error) {
    if (const SharedBytes message = connection->session->next()) {
      co_await write_message(connection->stream, *message, error);
    } else if (const std::optional<Closing> closing = connection->session->closing()) {
      co_await close(*connection, *closing);
      break;
    } else if (!connection->reading) {
      break;
    } else {
      // The wait is cancelled when there is something new, so its error is expected.
      error_code woken;
      connection->something_to_send.expires_after(kPingPeriod);
      co_await connection->something_to_send.async_wait(
          asio::redirect_error(asio::use_awaitable, woken));
      if (!woken) co_await write_ping(connection->stream, error);
    }
  }
  // Closing the socket also ends the reading coroutine.
  beast::get_lowest_layer(connection->stream.socket).close();
}

asio::awaitable<void> read_messages(Connection& connection) {
  const std::function<std::size_t()> max_bytes = [&connection] {
    return connection.session->max_message_bytes();
  };
  for (;;) {
    const ReadMessage read = co_await read_message(connection.stream, max_bytes);
    if (read.error) co_return;
    if (const std::optional<Refusal> wrong = objection_to(read, max_bytes())) {
      connection.session->fail(wrong->error, wrong->code);
      co_return;
    }
    connection.session->receive(connection.stream.bytes());
  }
}

// Records the session in the audit log if it has changed, since a waiting client does not know its
// scan yet.
void note_session(Connection& connection, const HttpWorld& world, const std::string& address) {
  const std::string what = connection.session->what(), scan_id = connection.session->scan_id();
  if (connection.noted == what + scan_id) return;
  connection.noted = what + scan_id;
  world.audit.note({unix_now_ms(), connection.grant.token_id, address, what, scan_id, "let in"});
}

// Ends the session soon after its token has expired or was revoked. It polls, so that nothing has
// to track which connections use which token.
void watch_grant(const std::shared_ptr<Connection>& connection, const HttpWorld& world,
                 const std::string& address) {
  connection->grant_check.expires_after(kGrantCheck);
  connection->grant_check.async_wait(
      [weak = std::weak_ptr(connection), &world, address](const error_code& cancelled) {
        const std::shared_ptr<Connection> watched = weak.lock();
        if (cancelled || !watched) return;
        note_session(*watched, world, address);
        if (world.gate.holds(watched->grant, unix_now_ms()))
          return watch_grant(watched, world, address);
        watched->session->fail(
            {ErrorCode::kUnauthorized, "the token or share link has expired or was revoked"},
            CloseCode::kUnauthorized);
      });
}

// Reads the first message and answers it. Afterwards there is a session, or the connection has
// ended.
asio::awaitable<void> begin(const std::shared_ptr<Connection>& connection, const HttpWorld& world,
                            const Peer& peer) {
  connection->hello_deadline.expires_after(kHelloPatience);
  connection->hello_deadline.async_wait(
      [weak = std::weak_ptr(connection)](const error_code& cancelled) {
        const std::shared_ptr<Connection> late = weak.lock();
        if (!cancelled && late && !late->session)
          beast::get_lowest_layer(late->stream.socket).close();
      });
  const std::function<std::size_t()> max_bytes = [] { return wire::kMaxBytesBeforeWelcome; };
  const ReadMessage read = co_await read_message(connection->stream, max_bytes);
  if (read.error) co_return;
  std::optional<Refusal> wrong = objection_to(read, max_bytes());
  if (!wrong) {
    auto wake = [weak = std::weak_ptr(connection)] {
      if (const std::shared_ptr<Connection> awake = weak.lock()) awake->something_to_send.cancel();
    };
    const auto admit = [&world, &peer, &connection](const std::string& secret) {
      Result<Grant> grant =
          world.gate.admit(secret, {address_group(peer.address), unix_now_ms(), peer.address});
      if (!grant.ok() && !is_of_store(grant.error())) world.metrics.authentication_failed();
      if (!grant.ok()) return grant;
      auto place = world.sessions.enter(grant->token_id, may(*grant, Scope::kAdmin), "connections");
      if (!place.ok()) return Result<Grant>(place.error());
      connection->tokens_place = *std::move(place);
      return grant;
    };
    auto greeting = greet(world.scans, admit, connection->stream.bytes(), std::move(wake));
    if (auto* greeted = std::get_if<Greeted>(&greeting)) {
      connection->session = std::move(greeted->session);
      connection->grant = std::move(greeted->grant);
      note_session(*connection, world, peer.address);
      log_with({{}, peer.address}, spdlog::level::info,
               "a connection let in with token " + connection->grant.token_id);
      co_return;
    }
    wrong = std::get<Refusal>(std::move(greeting));
  }
  log_with({{}, peer.address}, spdlog::level::info, "connection refused: " + wrong->error.message);
  world.metrics.websocket_closed(static_cast<int>(wrong->code));
  error_code error;
  const std::string message = format_error(wrong->error);
  co_await write_message(connection->stream, message, error);
  // A named variable, because GCC 12 destroys a braced temporary twice when it is an argument of
  // co_await.
  const Closing closing{wrong->code, wrong->error.message};
  if (!error) co_await close(*connection, closing);
}

}  // namespace

bool offers_subprotocol(const beast::http::request<beast::http::empty_body>& upgrade) {
  const beast::http::token_list offered(upgrade[beast::http::field::sec_websocket_protocol]);
  for (const auto name : offered)
    if (name == wire::kSubprotocol) return true;
  return false;
}

asio::awaitable<void> serve_websocket(Transport stream,
                                      beast::http::request<beast::http::empty_body> upgrade,
                                      const HttpWorld& world, Peer peer) {
  const auto start = std::chrono::steady_clock::now();
  stream.next_layer().expires_never();
  const auto connection = std::make_shared<Connection>(std::move(stream));
  error_code error;
  const std::string subprotocol(wire::kSubprotocol);
  co_await accept(connection->stream, upgrade, subprotocol, error);
  if (error) co_return;
  co_await begin(connection, world, peer);
  connection->hello_deadline.cancel();
  if (!connection->session) co_return;
  watch_grant(connection, world, peer.address);
  asio::co_spawn(connection->stream.socket.get_executor(), write_messages(connection),
                 asio::detached);
  co_await read_messages(*connection);
  const std::optional<Closing> closing = connection->session->closing();
  const int code = closing ? static_cast<int>(closing->code) : kClosedByThem;
  world.metrics.websocket_closed(code);
  const double duration_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  log_with({{}, peer.address, duration_s}, spdlog::level::debug,
           fmt::format("connection closed with code {}", code));
  note_session(*connection, world, peer.address);
  connection->session->disconnected();
  connection->reading = false;
  connection->grant_check.cancel();
  connection->something_to_send.cancel();
}

}  // namespace hermite::server
