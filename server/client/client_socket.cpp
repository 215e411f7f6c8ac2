#include "server/client/client_socket.h"

#include <fmt/core.h>

#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "proto/wire/messages.h"

namespace hermite::client {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;

// A server that answers no ping for this long is considered dead. Pings are sent at half this
// interval, which also keeps proxies from closing the connection (60 s).
constexpr std::chrono::seconds kSilence(45);
// Halves the cost of a write compared to Beast's 4 KiB.
constexpr std::size_t kWriteBuffer_bytes = 65536;

Error refusal(const std::string& server, const websocket::response_type& response,
              const beast::error_code& error) {
  if (error != websocket::error::upgrade_declined) {
    return {ErrorCode::kIo,
            fmt::format("the WebSocket handshake with {} failed: {}", server, error.message())};
  }
  const unsigned status = response.result_int();
  const std::string answer = fmt::format("HTTP {} {}", status, std::string(response.reason()));
  if (status == 401 || status == 403)
    return {ErrorCode::kUnauthorized, fmt::format("{} refuses the connection: {}", server, answer)};
  if (status == 429 || status == 503)
    return {ErrorCode::kBusy, fmt::format("{} is busy: {}", server, answer)};
  return {ErrorCode::kUnsupported,
          fmt::format("{} is no Hermite server: it answers {}", server, answer)};
}

// Returns what is wrong with the server's certificate, as text.
Error distrust(const std::string& server, const beast::error_code& error,
               server::Transport::Tls& tls) {
  const long verdict = SSL_get_verify_result(tls.native_handle());
  if (verdict == X509_V_OK)
    return {ErrorCode::kIo, fmt::format("TLS with {} failed: {}", server, error.message())};
  return {ErrorCode::kUnauthorized, fmt::format("the certificate of {} is not trusted: {} (--ca "
                                                "names a file with the authorities to trust)",
                                                server, X509_verify_cert_error_string(verdict))};
}

// Performs the TLS handshake, accepting only the server that `url` names.
asio::awaitable<void> shake_hands(server::Transport::Tls& tls, const ServerUrl& url,
                                  std::optional<Error>& failure) {
  beast::error_code error;
  asio::ip::make_address(url.host, error);
  const bool is_name = static_cast<bool>(error);
  // The server name indication (SNI) must not contain an address.
  if (is_name) SSL_set_tlsext_host_name(tls.native_handle(), url.host.c_str());
  tls.set_verify_callback(asio::ssl::host_name_verification(url.host));
  co_await tls.async_handshake(asio::ssl::stream_base::client,
                               asio::redirect_error(asio::use_awaitable, error));
  if (error) failure = distrust(url.host_and_port(), error, tls);
}

}  // namespace

void prepare_socket(ClientSocket& socket, std::chrono::milliseconds patience) {
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

asio::awaitable<void> connect_socket(ClientSocket& socket, const ServerUrl& url,
                                     std::optional<Error>& failure) {
  const std::string server = url.host_and_port();
  beast::error_code error;
  const auto then = [&error] { return asio::redirect_error(asio::use_awaitable, error); };
  tcp::resolver resolver(socket.get_executor());
  const auto addresses =
      co_await resolver.async_resolve(url.host, std::to_string(url.port), then());
  if (error) {
    failure = Error{ErrorCode::kIo, fmt::format("cannot find {}: {}", server, error.message())};
    co_return;
  }
  co_await beast::get_lowest_layer(socket).async_connect(addresses, then());
  if (error) {
    failure =
        Error{ErrorCode::kIo, fmt::format("cannot connect to {}: {}", server, error.message())};
    co_return;
  }
  beast::get_lowest_layer(socket).socket().set_option(tcp::no_delay(true));
  if (socket.next_layer().tls()) co_await shake_hands(*socket.next_layer().tls(), url, failure);
  if (failure) co_return;
  beast::get_lowest_layer(socket).expires_never();  // from here on the WebSocket has its own limits
  websocket::response_type response;
  co_await socket.async_handshake(response, server, wire::kEndpoint, then());
  if (error) {
    failure = refusal(server, response, error);
    co_return;
  }
  if (response[http::field::sec_websocket_protocol] != wire::kSubprotocol) {
    failure = Error{ErrorCode::kUnsupported,
                    fmt::format("{} does not speak the protocol {}", server, wire::kSubprotocol)};
  }
}

std::string why_ended(const ClientSocket& socket, const beast::error_code& error) {
  if (error == websocket::error::closed) {
    const auto& reason = socket.reason();
    return fmt::format("the server closed it (code {}{}{})", reason.code,
                       reason.reason.empty() ? "" : ", ",
                       std::string(reason.reason.data(), reason.reason.size()));
  }
  if (error == beast::error::timeout)
    return fmt::format("no sign of life for {} s", kSilence.count());
  return error.message();
}

}  // namespace hermite::client
