#include "server/connections/http_connection.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <limits>
#include <optional>
#include <string>

#include "server/connections/answer_writer.h"
#include "server/connections/body_reader.h"
#include "server/connections/websocket.h"
#include "server/net/run_on.h"
#include "server/net/transport.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;
using Request = http::request<http::empty_body>;

// Time for a whole header, also between two requests.
constexpr std::chrono::seconds kRequestPatience(10);
constexpr std::chrono::seconds kTlsGoodbyePatience(5);  // for the TLS shutdown
constexpr std::chrono::milliseconds kLingerPatience(1000);
constexpr std::chrono::milliseconds kRefusalPatience(500);
constexpr std::size_t kLingerBytes = 256 * 1024;
// A request whose upload is still being written to by another request waits until the disk
// operation of that one has ended; its reading is cancelled at once.
constexpr std::chrono::milliseconds kWriterPatience(10'000), kWriterCheck(20);

std::string text_of(beast::string_view view) { return {view.data(), view.size()}; }

// Returns what is wrong with a request regardless of what it asks for; std::nullopt if nothing is.
// `body_bytes` is the announced length of its body.
std::optional<HttpAnswer> check_request(const Request& request, std::uint64_t body_bytes,
                                        bool long_body, const AllowedHosts& hosts) {
  const auto refuse = [](int status, const std::string& message) {
    return error_answer(
        status, {status == 403 ? ErrorCode::kUnauthorized : ErrorCode::kInvalidArgument, message});
  };
  if (request.version() != 11 && request.version() != 10)
    return refuse(505, "HTTP/1.1 or 1.0 is spoken here");
  // Transfer codings are where proxies and servers disagree about the end of a request, and none is
  // needed here.
  if (request.count(http::field::transfer_encoding) != 0)
    return refuse(400, "requests with Transfer-Encoding are not accepted");
  const bool may_have_body =
      request.method() == http::verb::post || request.method() == http::verb::patch || long_body;
  if (body_bytes > 0 && !may_have_body)
    return refuse(400, "only POST and PATCH requests may have a body here");
  if (body_bytes > kMaxBodyBytes && !long_body)
    return refuse(413,
                  fmt::format("the body has {} bytes, allowed are {}", body_bytes, kMaxBodyBytes));
  if (request.count(http::field::host) != 1)
    return refuse(400, "a request must have one Host header");
  if (!host_allowed(hosts, text_of(request[http::field::host])))
    return refuse(
        403,
        "the Host header names a host that this server does not answer for (see --allow-host)");
  const std::string origin = text_of(request[http::field::origin]);
  if (request.count(http::field::origin) > 1 ||
      (request.count(http::field::origin) == 1 && !origin_allowed(hosts, origin)))
    return refuse(403,
                  "the Origin header names a site that may not use this server (see --allow-host)");
  if (request.target().empty() || request.target().front() != '/')
    return refuse(400, "the request target must start with /");
  return std::nullopt;
}

std::optional<HttpAnswer> check_upgrade(const Request& request) {
  if (request.target() != wire::kEndpoint)
    return error_answer(
        404, {ErrorCode::kNotFound, "WebSockets are at " + std::string(wire::kEndpoint)});
  if (!offers_subprotocol(request))
    return error_answer(400, {ErrorCode::kUnsupported, "the WebSocket must offer the subprotocol " +
                                                           std::string(wire::kSubprotocol)});
  return std::nullopt;
}

HttpRequest plain(const Request& request, Caller caller, std::uint64_t body_bytes) {
  const std::string target = text_of(request.target());
  const std::size_t question = std::min(target.find('?'), target.size());
  HttpRequest copy{text_of(request.method_string()),
                   target.substr(0, question),
                   target.substr(std::min(question + 1, target.size())),
                   text_of(request[http::field::authorization]),
                   {},
                   std::move(caller)};
  copy.body_bytes = body_bytes;
  for (const auto& field : request)
    copy.headers.emplace_back(text_of(field.name_string()), text_of(field.value()));
  return copy;
}

std::string joined(const Request& request, beast::string_view name) {
  std::string values;
  const auto [first, last] = request.equal_range(name);
  for (auto field = first; field != last; ++field)
    values += (values.empty() ? "" : ",") + text_of(field->value());
  return values;
}

Peer peer_of_request(const Request& request, const std::string& address, bool tls,
                     const Site& site) {
  return peer_of(address, tls, site.proxies, joined(request, "X-Forwarded-For"),
                 joined(request, "X-Forwarded-Proto"));
}

std::optional<HttpAnswer> check_encryption(const Peer& peer, const std::string& address,
                                           const Site& site) {
  // A proxy on this machine that is not a trusted one cannot be told from a local user.
  const bool from_here = is_loopback({address, 0}) && !lies_in_any(site.proxies, address);
  if (!site.encrypted_only || peer.encrypted || from_here) return std::nullopt;
  return error_answer(403, {ErrorCode::kUnauthorized,
                            "this server is reached over TLS only: by https, or through its proxy "
                            "(--trusted-proxy), which has to send "
                            "X-Forwarded-Proto: https"});
}

// Returns the answer to a header that could not be read; std::nullopt if nobody would read the
// answer.
std::optional<HttpAnswer> answer_to(const error_code& error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow)
    return error_answer(
        431, {ErrorCode::kTooLarge,
              fmt::format("the request's header is longer than {} bytes", kMaxHeaderBytes)});
  // When the other side closed the connection or the time has run out, nobody reads an answer.
  const bool cut = error == http::error::end_of_stream || error == http::error::partial_message;
  if (cut || error.category() != http::make_error_code(http::error::bad_method).category())
    return std::nullopt;
  return error_answer(400,
                      {ErrorCode::kCorruptData, "this is no HTTP request: " + error.message()});
}

// Reads and discards for a moment what the client still sends after an answer that ends the
// connection, because closing a socket with unread bytes resets the connection and can destroy the
// answer.
asio::awaitable<void> linger(Transport& transport) {
  error_code error;
  beast::tcp_stream& stream = transport.next_layer();
  if (transport.tls()) {
    stream.expires_after(kTlsGoodbyePatience);
    co_await transport.tls()->async_shutdown(asio::redirect_error(asio::use_awaitable, error));
    error = {};
  }
  stream.socket().shutdown(asio::ip::tcp::socket::shutdown_send, error);
  stream.expires_after(kLingerPatience);
  std::array<char, 4096> forgotten;
  for (std::size_t total = 0; !error && total < kLingerBytes;)
    total += co_await stream.async_read_some(asio::buffer(forgotten),
                                             asio::redirect_error(asio::use_awaitable, error));
}

// Reads the body announced in the header, which is consumed; std::nullopt if the connection ended
// first.
asio::awaitable<std::optional<std::string>> read_body(Transport& stream, beast::flat_buffer& buffer,
                                                      HeaderParser& header) {
  http::request_parser<http::string_body> parser(std::move(header));
  parser.body_limit(kMaxBodyBytes);
  error_code error;
  stream.next_layer().expires_after(kRequestPatience);
  co_await http::async_read(stream, buffer, parser,
                            asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return std::nullopt;
  co_return std::move(parser.get().body());
}

bool is_long(const HttpRequest& request, const Site& site) {
  return site.disk && takes_long_body(request);
}

// Returns the site's answer, repeating the request while another one is in its way, for at most
// kWriterPatience.
asio::awaitable<HttpAnswer> answer_patiently(Transport& stream, const Site& site,
                                             HttpRequest& request) {
  HttpAnswer answer = site.answer(request);
  asio::steady_timer pause(stream.get_executor());
  for (auto waited = std::chrono::milliseconds(0); answer.ask_again && waited < kWriterPatience;
       waited += kWriterCheck) {
    error_code ignored;
    pause.expires_after(kWriterCheck);
    co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    request.caller.now_ms = unix_now_ms();
    request.asked_again = true;
    answer = site.answer(request);
  }
  co_return answer;
}

// Returns why a request is refused before its body is read; std::nullopt if it is not.
std::optional<HttpAnswer> check(const HeaderParser& parser, const HttpRequest& request,
                                const Peer& peer, const std::string& address, const Site& site) {
  const std::int64_t wait_ms =
      site.requests ? site.requests->take(request.caller.address, request.caller.now_ms) : 0;
  if (wait_ms > 0) return wait_answer(429, "too many requests from this address", wait_ms);
  std::optional<HttpAnswer> wrong =
      check_request(parser.get(), request.body_bytes, is_long(request, site), site.hosts);
  if (!wrong) wrong = check_encryption(peer, address, site);
  if (!wrong && site.websockets && beast::websocket::is_upgrade(parser.get()))
    wrong = check_upgrade(parser.get());
  return wrong;
}

// Returns whether the connection can be used.
asio::awaitable<bool> shake_hands(Transport& stream, std::chrono::milliseconds patience) {
  error_code error;
  if (!stream.tls()) co_return true;
  stream.next_layer().expires_after(patience);
  co_await stream.tls()->async_handshake(asio::ssl::stream_base::server,
                                         asio::redirect_error(asio::use_awaitable, error));
  co_return !error;
}

// A request whose header was received.
struct Incoming {
  Transport& stream;
  beast::flat_buffer& buffer;
  HeaderParser& parser;
};

// Returns whether the connection can continue.
asio::awaitable<bool> answer_request(Incoming incoming, const Site& site,
                                     std::optional<HttpAnswer> wrong, HttpRequest request,
                                     Answering how) {
  auto& [stream, buffer, parser] = incoming;
  const auto start = std::chrono::steady_clock::now();
  if (wrong) how.keep_alive = false;
  if (!wrong) {
    const bool long_body = is_long(request, site);
    if (request.body_bytes > 0 && !long_body) {
      std::optional<std::string> body = co_await read_body(stream, buffer, parser);
      if (!body) co_return false;
      request.body = *std::move(body);
    }
    HttpAnswer answer = co_await answer_patiently(stream, site, request);
    if (const std::shared_ptr<BodySink> sink = std::exchange(answer.body_sink, nullptr)) {
      const std::string_view named = answer.route;
      const bool complete = co_await receive_body(stream, buffer, parser, *site.disk, *sink);
      answer = sink->answer();
      answer.route = named;
      how.keep_alive = how.keep_alive && complete;
    } else if (const std::function<HttpAnswer()> work = std::exchange(answer.work, nullptr);
               work && site.disk) {
      const std::string_view named = answer.route;
      auto make = [&] { answer = work(); };
      co_await run_on(*site.disk, make);
      answer.route = named;
    } else if (long_body && request.body_bytes > 0) {
      how.keep_alive = false;  // the body that follows is not read
    }
    wrong = std::move(answer);
  }
  const int status = wrong->status;
  const std::string_view route = wrong->route;
  const bool go_on = co_await write_answer(stream, *std::move(wrong), how, site.disk);
  site.metrics.request_answered(
      route, status,
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  co_return go_on;
}

}  // namespace

asio::awaitable<void> serve_connection(asio::ip::tcp::socket socket, std::string address,
                                       TlsContext tls, const Site& site) {
  error_code error;
  // Without it small messages take three times as long.
  socket.set_option(asio::ip::tcp::no_delay(true), error);
  Transport stream(beast::tcp_stream(std::move(socket)), std::move(tls));
  beast::flat_buffer buffer(2 * kMaxHeaderBytes);
  const bool usable = co_await shake_hands(stream, kRequestPatience);
  bool go_on = !error && usable;
  while (go_on) {
    HeaderParser parser;
    parser.header_limit(kMaxHeaderBytes);
    // check_request has its own error message.
    parser.body_limit(std::numeric_limits<std::uint64_t>::max());
    stream.next_layer().expires_after(kRequestPatience);
    co_await http::async_read_header(stream, buffer, parser,
                                     asio::redirect_error(asio::use_awaitable, error));
    if (error) {
      std::optional<HttpAnswer> answer = answer_to(error);
      if (answer) co_await write_answer(stream, *std::move(answer), {}, nullptr);
      break;
    }
    const Request& request = parser.get();
    Peer peer = peer_of_request(request, address, stream.encrypted(), site);
    Caller caller{address_group(peer.address), unix_now_ms(), peer.address};
    HttpRequest asked = plain(request, std::move(caller), parser.content_length().value_or(0));
    std::optional<HttpAnswer> wrong = check(parser, asked, peer, address, site);
    if (!wrong && site.websockets && beast::websocket::is_upgrade(request)) {
      co_await serve_websocket(std::move(stream), parser.release(), *site.websockets,
                               std::move(peer));
      co_return;
    }
    const Answering how{request.version(), peer.encrypted, request.method() == http::verb::head,
                        request.keep_alive()};
    go_on = co_await answer_request({stream, buffer, parser}, site, std::move(wrong),
                                    std::move(asked), how);
  }
  co_await linger(stream);
}

asio::awaitable<void> refuse_connection(asio::ip::tcp::socket socket, TlsContext tls,
                                        HttpAnswer answer) {
  Transport stream(beast::tcp_stream(std::move(socket)), std::move(tls));
  const bool usable = co_await shake_hands(stream, kRefusalPatience);
  if (!usable) co_return;
  // The client may already have sent a request, which is discarded without being parsed.
  std::array<char, 1024> forgotten;
  error_code ignored;
  stream.next_layer().expires_after(kRefusalPatience);
  co_await stream.async_read_some(asio::buffer(forgotten),
                                  asio::redirect_error(asio::use_awaitable, ignored));
  co_await write_answer(stream, std::move(answer), {}, nullptr);
  co_await linger(stream);
}

}  // namespace hermite::server
