#include "server/client/http_exchange.h"

#include <utility>  // before asio/awaitable.hpp, see transport.h

#include <fmt/core.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>

#include "server/net/transport.h"

namespace hermite::client {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds kPatience(60);  // without progress

Error io_error(const ServerUrl& server, const std::string& what) {
  return {ErrorCode::kIo, fmt::format("the server at {}: {}", server.host_and_port(), what)};
}

asio::awaitable<error_code> open(server::Transport& stream, const ServerUrl& server,
                                 bool check_name) {
  error_code error;
  stream.next_layer().expires_after(kPatience);
  tcp::resolver resolver(stream.get_executor());
  const auto endpoints = co_await resolver.async_resolve(
      server.host, std::to_string(server.port), asio::redirect_error(asio::use_awaitable, error));
  if (!error)
    co_await stream.next_layer().async_connect(endpoints,
                                               asio::redirect_error(asio::use_awaitable, error));
  if (error || !stream.tls()) co_return error;
  if (check_name) {
    error_code no_address;
    asio::ip::make_address(server.host, no_address);
    // The server name indication (SNI) must not contain an address.
    if (no_address) SSL_set_tlsext_host_name(stream.tls()->native_handle(), server.host.c_str());
    stream.tls()->set_verify_callback(asio::ssl::host_name_verification(server.host), error);
  }
  if (!error)
    co_await stream.tls()->async_handshake(asio::ssl::stream_base::client,
                                           asio::redirect_error(asio::use_awaitable, error));
  co_return error;
}

struct Conversation {
  std::string request, answer;
  error_code error;
};

// Sends the request, then reads until the server closes the connection. A server that refuses a
// long request may stop reading it; its answer counts all the same.
asio::awaitable<void> converse(server::Transport& stream, const ServerUrl& server, bool check_name,
                               Conversation& talk) {
  auto& [request, answer, error] = talk;
  error = co_await open(stream, server, check_name);
  if (error) co_return;
  for (std::size_t sent = 0; !error && sent < request.size();) {
    stream.next_layer().expires_after(kPatience);
    const auto rest = asio::buffer(request.data() + sent,
                                   std::min<std::size_t>(request.size() - sent, 64 * 1024));
    sent +=
        co_await stream.async_write_some(rest, asio::redirect_error(asio::use_awaitable, error));
  }
  const error_code not_sent = std::exchange(error, {});
  std::array<char, 16 * 1024> piece;
  while (!error && answer.size() < kMaxApiAnswerBytes) {
    stream.next_layer().expires_after(kPatience);
    const std::size_t count = co_await stream.async_read_some(
        asio::buffer(piece), asio::redirect_error(asio::use_awaitable, error));
    answer.append(piece.data(), count);
  }
  if (error == asio::error::eof || error == asio::ssl::error::stream_truncated || !answer.empty())
    error = {};
  if (not_sent && answer.empty()) error = not_sent;
}

ErrorCode code_of(int status) {
  switch (status) {
    case 401:
    case 403: return ErrorCode::kUnauthorized;
    case 404:
    case 410: return ErrorCode::kNotFound;
    case 409:
    case 423:
    case 429:
    case 503: return ErrorCode::kBusy;
    case 413: return ErrorCode::kTooLarge;
    default: return status < 500 ? ErrorCode::kInvalidArgument : ErrorCode::kIo;
  }
}

std::string request_text(const ServerUrl& server, const HttpCall& call) {
  // A server that listens on all addresses accepts the name of the loopback address.
  const bool any = server.host == "0.0.0.0" || server.host == "::";
  std::string text =
      fmt::format("{} {} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nAuthorization: Bearer {}\r\n",
                  call.method, call.path, any ? "localhost" : server.host_and_port(), server.token);
  for (const auto& [name, value] : call.headers) text += fmt::format("{}: {}\r\n", name, value);
  return fmt::format("{}Content-Length: {}\r\n\r\n{}", text, call.body.size(), call.body);
}

}  // namespace

std::optional<std::string> HttpReply::field(const std::string& name) const {
  const auto lower = [](std::string text) {
    for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
  };
  const std::string lowered = lower(header), wanted = fmt::format("\r\n{}:", lower(name));
  const std::size_t at = lowered.find(wanted);
  if (at == std::string::npos) return std::nullopt;
  const std::size_t end = header.find("\r\n", at + 2);
  std::string value = header.substr(at + wanted.size(), end - at - wanted.size());
  value.erase(0, value.find_first_not_of(' '));
  return value;
}

Result<HttpReply> http_exchange(const ServerUrl& server, const server::TlsContext& tls,
                                bool check_name, const HttpCall& call) {
  asio::io_context context;
  server::Transport stream(server::Transport::Tcp(context), tls);
  Conversation talk{request_text(server, call), {}, {}};
  asio::co_spawn(context, converse(stream, server, check_name, talk), asio::detached);
  context.run();
  const auto& [request, answer, error] = talk;
  if (error) return io_error(server, error.message());
  constexpr std::string_view kVersion = "HTTP/1.1 ";
  HttpReply reply;
  const std::size_t header_end = answer.find("\r\n\r\n");
  if (answer.compare(0, kVersion.size(), kVersion) == 0 && answer.size() >= kVersion.size() + 3)
    std::from_chars(answer.data() + kVersion.size(), answer.data() + kVersion.size() + 3,
                    reply.status);
  if (header_end == std::string::npos || reply.status < 200)
    return io_error(server, "its answer is no HTTP answer, or was cut");
  reply.header = answer.substr(0, header_end + 2);
  reply.body = answer.substr(header_end + 4);
  std::size_t stated = 0;
  const std::string length = reply.field("Content-Length").value_or("0");
  std::from_chars(length.data(), length.data() + length.size(), stated);
  if (call.method != "HEAD" && reply.body.size() < stated)
    return io_error(server, "its answer was cut");
  return reply;
}

Result<std::string> accepted_body(const ServerUrl& server, const server::TlsContext& tls,
                                  bool check_name, HttpCall call) {
  if (!call.body.empty()) call.headers.emplace_back("Content-Type", "application/json");
  Result<HttpReply> reply = http_exchange(server, tls, check_name, call);
  if (!reply.ok()) return reply.error();
  if (reply->status >= 300) return refusal(*reply);
  return std::move(reply->body);
}

Error refusal(const HttpReply& reply) {
  const nlohmann::json json = nlohmann::json::parse(reply.body, nullptr, false);
  const std::string otherwise = fmt::format("it answered with HTTP {}", reply.status);
  const bool has_message = json.is_object() && json.contains("error") && json["error"].is_object();
  return {code_of(reply.status),
          has_message ? json["error"].value("message", otherwise) : otherwise};
}

}  // namespace hermite::client
