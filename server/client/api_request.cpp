#include "server/client/api_request.h"

#include <sys/socket.h>
#include <sys/time.h>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <charconv>
#include <nlohmann/json.hpp>

namespace hermite {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

Error io_error(const ServerUrl& server, const std::string& what) {
  return {ErrorCode::kIo, "the server at " + server.host_and_port() + ": " + what};
}

// All that the server sends until it closes.
Result<std::string> exchange(const ServerUrl& server, const std::string& request) {
  asio::io_context context;
  error_code error;
  tcp::resolver resolver(context);
  const auto endpoints = resolver.resolve(server.host, std::to_string(server.port), error);
  if (error) return io_error(server, error.message());
  tcp::socket socket(context);
  asio::connect(socket, endpoints, error);
  if (error) return io_error(server, error.message());
  constexpr timeval kPatience{60, 0};
  setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &kPatience, sizeof kPatience);
  asio::write(socket, asio::buffer(request), error);
  if (error) return io_error(server, error.message());
  std::string answer;
  asio::read(socket, asio::dynamic_buffer(answer, kMaxApiAnswerBytes), error);
  if (error && error != asio::error::eof) return io_error(server, error.message());
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
