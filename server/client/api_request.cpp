#include "server/client/api_request.h"

#include <utility>  // before asio/awaitable.hpp, see transport.h

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>

#include "server/net/transport.h"

namespace hermite {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

Error io_error(const ServerUrl& server, const std::string& what) {
  return {ErrorCode::kIo, "the server at " + server.host_and_port() + ": " + what};
}

// All that the server sends until it closes.
asio::awaitable<void> converse(Transport& stream, const ServerUrl& server, const std::string& request, std::string& answer,
                               error_code& error) {
  constexpr std::chrono::seconds kPatience(60);
  stream.next_layer().expires_after(kPatience);
  tcp::resolver resolver(stream.get_executor());
  const auto endpoints =
      co_await resolver.async_resolve(server.host, std::to_string(server.port), asio::redirect_error(asio::use_awaitable, error));
  if (!error) co_await stream.next_layer().async_connect(endpoints, asio::redirect_error(asio::use_awaitable, error));
  if (!error && stream.tls())
    co_await stream.tls()->async_handshake(asio::ssl::stream_base::client, asio::redirect_error(asio::use_awaitable, error));
  if (!error) co_await asio::async_write(stream, asio::buffer(request), asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return;
  co_await asio::async_read(stream, asio::dynamic_buffer(answer, kMaxApiAnswerBytes), asio::redirect_error(asio::use_awaitable, error));
  if (error == asio::error::eof || error == asio::ssl::error::stream_truncated) error = {};
}

Result<std::string> exchange(const ServerUrl& server, const std::string& request) {
  TlsContext tls;
  if (server.tls) {
    Result<TlsContext> made = unverified_client_tls();
    if (!made.ok()) return made.error();
    tls = *std::move(made);
  }
  asio::io_context context;
  Transport stream(Transport::Tcp(context), std::move(tls));
  std::string answer;
  error_code error;
  asio::co_spawn(context, converse(stream, server, request, answer, error), asio::detached);
  context.run();
  if (error) return io_error(server, error.message());
  return answer;
}

// The words of {"error": {"message": ...}}.
std::string words_of(const std::string& body, int status) {
  const nlohmann::json json = nlohmann::json::parse(body, nullptr, false);
  const std::string otherwise = "it answered with HTTP " + std::to_string(status);
  if (!json.is_object() || !json.contains("error") || !json["error"].is_object()) return otherwise;
  return json["error"].value("message", otherwise);
}

ErrorCode code_of(int status) {
  switch (status) {
    case 401:
    case 403: return ErrorCode::kUnauthorized;
    case 404: return ErrorCode::kNotFound;
    case 409:
    case 429:
    case 503: return ErrorCode::kBusy;
    default: return status < 500 ? ErrorCode::kInvalidArgument : ErrorCode::kIo;
  }
}

}  // namespace

Result<std::string> api_request(const ServerUrl& server, const std::string& method, const std::string& path, const std::string& body) {
  // A server that listens on all addresses answers for the loopback's name.
  const bool any = server.host == "0.0.0.0" || server.host == "::";
  const std::string host = any ? "localhost" : server.host_and_port();
  const std::string request = method + " " + path + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\nAuthorization: Bearer " +
                              server.token + "\r\n" + (body.empty() ? "" : "Content-Type: application/json\r\n") +
                              "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
  Result<std::string> answer = exchange(server, request);
  if (!answer.ok()) return answer;
  constexpr std::string_view kVersion = "HTTP/1.1 ";
  const std::size_t header_end = answer->find("\r\n\r\n");
  int status = 0;
  if (answer->compare(0, kVersion.size(), kVersion) == 0 && answer->size() >= kVersion.size() + 3)
    std::from_chars(answer->data() + kVersion.size(), answer->data() + kVersion.size() + 3, status);
  if (header_end == std::string::npos || status < 200) return io_error(server, "its answer is no HTTP answer, or was cut");
  std::string content = answer->substr(header_end + 4);
  if (status >= 300) return Error{code_of(status), words_of(content, status)};
  return content;
}

}  // namespace hermite
