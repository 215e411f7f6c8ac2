#include "server/service/http_connection.h"

#include <spdlog/spdlog.h>

#include <array>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <limits>
#include <optional>
#include <string>

#include "server/service/websocket.h"
#include "server/store/unix_time.h"

namespace hermite {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;
using Request = http::request<http::empty_body>;

constexpr std::chrono::seconds kRequestPatience(10);  // for a whole header, also between two requests
constexpr std::chrono::seconds kAnswerPatience(60);   // without progress while an answer is written
constexpr std::chrono::milliseconds kLingerPatience(1000);
constexpr std::chrono::milliseconds kRefusalPatience(500);
constexpr std::size_t kLingerBytes = 256 * 1024;

std::string text_of(beast::string_view view) { return {view.data(), view.size()}; }

template <class Response>
void set_headers(Response& response, const HttpAnswer& answer, bool keep_alive) {
  response.set(http::field::server, "hermite");
  response.set(http::field::content_type, answer.content_type);
  response.set(http::field::cache_control, answer.cache_control);
  // The viewer's Draco decoder is WebAssembly in a worker; nothing comes from anywhere else.
  response.set("Content-Security-Policy",
               "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'; style-src 'self'; "
               "img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  if (!answer.download_name.empty())
    response.set(http::field::content_disposition, "attachment; filename=\"" + answer.download_name + "\"");
  if (!answer.allow.empty()) response.set(http::field::allow, answer.allow);
  if (answer.retry_after_s > 0) response.set(http::field::retry_after, std::to_string(answer.retry_after_s));
  if (answer.status == 401) response.set(http::field::www_authenticate, "Bearer");
  response.keep_alive(keep_alive);
}

struct Answering {
  unsigned int version = 11;
  bool head = false;  // the answer goes without its body
  bool keep_alive = false;
};

asio::awaitable<bool> write_file(beast::tcp_stream& stream, const HttpAnswer& answer, const Answering& how) {
  http::response<http::file_body> response{http::status::ok, how.version};
  error_code error;
  response.body().open(answer.file.c_str(), beast::file_mode::scan, error);
  if (error) co_return false;  // deleted this moment: the connection ends
  set_headers(response, answer, how.keep_alive);
  response.prepare_payload();
  http::response_serializer<http::file_body> serializer(response);
  if (how.head) {
    stream.expires_after(kAnswerPatience);
    co_await http::async_write_header(stream, serializer, asio::redirect_error(asio::use_awaitable, error));
    co_return !error;
  }
  // Piece by piece, so that the patience is for progress and not for the whole of a large cloud.
  while (!error && !serializer.is_done()) {
    stream.expires_after(kAnswerPatience);
    co_await http::async_write_some(stream, serializer, asio::redirect_error(asio::use_awaitable, error));
  }
  co_return !error;
}

// True when the connection can go on.
asio::awaitable<bool> write_answer(beast::tcp_stream& stream, HttpAnswer answer, const Answering& how) {
  if (!answer.file.empty()) {
    const bool written = co_await write_file(stream, answer, how);
    co_return written&& how.keep_alive;
  }
  const bool keep_alive = how.keep_alive && answer.status < 400;
  http::response<http::string_body> response{static_cast<http::status>(answer.status), how.version};
  set_headers(response, answer, keep_alive);
  response.content_length(answer.body.size());
  if (!how.head) response.body() = std::move(answer.body);
  error_code error;
  stream.expires_after(kAnswerPatience);
  co_await http::async_write(stream, response, asio::redirect_error(asio::use_awaitable, error));
  co_return !error && keep_alive;
}

// What is wrong with a request as such, whatever it asks for. `body_bytes` are announced to follow.
std::optional<HttpAnswer> check_request(const Request& request, std::uint64_t body_bytes, const AllowedHosts& hosts) {
  const auto refuse = [](int status, const std::string& words) {
    return error_answer(status, {status == 403 ? ErrorCode::kUnauthorized : ErrorCode::kInvalidArgument, words});
  };
  if (request.version() != 11 && request.version() != 10) return refuse(505, "HTTP/1.1 or 1.0 is spoken here");
  // Transfer codings are where proxies and servers disagree about the end of a request; none is needed here.
  if (request.count(http::field::transfer_encoding) != 0) return refuse(400, "requests with Transfer-Encoding are not accepted");
  if (request.method() != http::verb::post && body_bytes > 0) return refuse(413, "only POST requests may have a body");
  if (body_bytes > kMaxBodyBytes)
    return refuse(413, "the body has " + std::to_string(body_bytes) + " bytes, allowed are " + std::to_string(kMaxBodyBytes));
  if (request.count(http::field::host) != 1) return refuse(400, "a request must have one Host header");
  if (!host_allowed(hosts, text_of(request[http::field::host])))
    return refuse(403, "the Host header names a host that this server does not answer for (see --allow-host)");
  const std::string origin = text_of(request[http::field::origin]);
  if (request.count(http::field::origin) > 1 || (request.count(http::field::origin) == 1 && !origin_allowed(hosts, origin)))
    return refuse(403, "the Origin header names a site that may not use this server (see --allow-host)");
  if (request.target().empty() || request.target().front() != '/') return refuse(400, "the request target must start with /");
  return std::nullopt;
}

std::optional<HttpAnswer> check_upgrade(const Request& request) {
  if (request.target() != wire::kEndpoint)
    return error_answer(404, {ErrorCode::kNotFound, "WebSockets are at " + std::string(wire::kEndpoint)});
  if (!offers_subprotocol(request))
    return error_answer(400, {ErrorCode::kUnsupported, "the WebSocket must offer the subprotocol " + std::string(wire::kSubprotocol)});
  return std::nullopt;
}

HttpRequest plain(const Request& request, std::string body, Caller caller) {
  const std::string target = text_of(request.target());
  return {text_of(request.method_string()), target.substr(0, target.find('?')), text_of(request[http::field::authorization]),
          std::move(body), std::move(caller)};
}

// The answer to a header that could not be read; none when there is nobody to answer.
std::optional<HttpAnswer> answer_to(const error_code& error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow)
    return error_answer(431, {ErrorCode::kTooLarge, "the request's header is longer than " + std::to_string(kMaxHeaderBytes) + " bytes"});
  // What is cut short by the other side or by the clock has no reader left.
  const bool cut = error == http::error::end_of_stream || error == http::error::partial_message;
  if (cut || error.category() != http::make_error_code(http::error::bad_method).category()) return std::nullopt;
  return error_answer(400, {ErrorCode::kCorruptData, "this is no HTTP request: " + error.message()});
}

// After an answer that ends the connection: what the client still sends is read and forgotten for a moment, because a socket that is closed
// with unread bytes takes back the answer.
asio::awaitable<void> linger(beast::tcp_stream& stream) {
  error_code error;
  stream.socket().shutdown(asio::ip::tcp::socket::shutdown_send, error);
  stream.expires_after(kLingerPatience);
  std::array<char, 4096> forgotten;
  for (std::size_t total = 0; !error && total < kLingerBytes;)
    total += co_await stream.async_read_some(asio::buffer(forgotten), asio::redirect_error(asio::use_awaitable, error));
}

using HeaderParser = http::request_parser<http::empty_body>;

// The body that was announced behind the header, which is used up; nothing when the connection ended first.
asio::awaitable<std::optional<std::string>> read_body(beast::tcp_stream& stream, beast::flat_buffer& buffer, HeaderParser& header) {
  http::request_parser<http::string_body> parser(std::move(header));
  parser.body_limit(kMaxBodyBytes);
  error_code error;
  stream.expires_after(kRequestPatience);
  co_await http::async_read(stream, buffer, parser, asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return std::nullopt;
  co_return std::move(parser.get().body());
}

// What a request is refused for before its body is read.
std::optional<HttpAnswer> check(const HeaderParser& parser, const Caller& caller, const RequestRules& rules) {
  if (const std::int64_t wait_ms = rules.requests.take(caller.address, caller.now_ms); wait_ms > 0)
    return wait_answer(429, "too many requests from this address", wait_ms);
  std::optional<HttpAnswer> wrong = check_request(parser.get(), parser.content_length().value_or(0), rules.hosts);
  if (!wrong && beast::websocket::is_upgrade(parser.get())) wrong = check_upgrade(parser.get());
  return wrong;
}

}  // namespace

asio::awaitable<void> serve_connection(asio::ip::tcp::socket socket, std::string address, const HttpWorld& world, RequestRules rules) {
  error_code error;
  socket.set_option(asio::ip::tcp::no_delay(true), error);  // three times slower without, on small messages
  beast::tcp_stream stream(std::move(socket));
  beast::flat_buffer buffer(2 * kMaxHeaderBytes);
  bool go_on = !error;
  while (go_on) {
    HeaderParser parser;
    parser.header_limit(kMaxHeaderBytes);
    parser.body_limit(std::numeric_limits<std::uint64_t>::max());  // check_request has its own words
    stream.expires_after(kRequestPatience);
    co_await http::async_read_header(stream, buffer, parser, asio::redirect_error(asio::use_awaitable, error));
    if (error) {
      std::optional<HttpAnswer> words = answer_to(error);
      if (!words) co_return;
      co_await write_answer(stream, *std::move(words), {});
      break;
    }
    const Caller caller{address, unix_now_ms()};
    Answering how{parser.get().version(), parser.get().method() == http::verb::head, parser.get().keep_alive()};
    std::optional<HttpAnswer> wrong = check(parser, caller, rules);
    if (wrong) {
      how.keep_alive = false;
    } else if (beast::websocket::is_upgrade(parser.get())) {
      WebSocketWorld beyond{world.scans, world.gate, address};
      co_await serve_websocket(std::move(stream), parser.release(), std::move(beyond));
      co_return;
    }
    HttpRequest request = plain(parser.get(), {}, caller);
    if (!wrong && parser.content_length().value_or(0) > 0) {
      std::optional<std::string> body = co_await read_body(stream, buffer, parser);
      if (!body) co_return;
      request.body = *std::move(body);
    }
    HttpAnswer reply = wrong ? *std::move(wrong) : answer(world, request);
    go_on = co_await write_answer(stream, std::move(reply), how);
  }
  co_await linger(stream);
}

asio::awaitable<void> refuse_connection(asio::ip::tcp::socket socket, HttpAnswer answer) {
  beast::tcp_stream stream(std::move(socket));
  // A client may speak first; what it said is not even looked at.
  std::array<char, 1024> forgotten;
  error_code ignored;
  stream.expires_after(kRefusalPatience);
  co_await stream.async_read_some(asio::buffer(forgotten), asio::redirect_error(asio::use_awaitable, ignored));
  co_await write_answer(stream, std::move(answer), {});
  co_await linger(stream);
}

}  // namespace hermite
