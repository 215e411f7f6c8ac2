#include "server/connections/websocket_stream.h"

#include <algorithm>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/websocket.hpp>

#include "proto/wire/without_paths.h"

namespace hermite::server {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

constexpr std::size_t kReadBytes = 64 * 1024;

}  // namespace

WebSocketStream::WebSocketStream(Transport transport, const WebSocketTimes& times)
    : socket(std::move(transport)) {
  socket.set_option(websocket::stream_base::timeout{times.close, times.idle, true});
  websocket::permessage_deflate off;
  off.server_enable = false;
  socket.set_option(off);
  socket.read_message_max(std::size_t{1} << 40);  // read_message() has its own limit
  socket.write_buffer_bytes(65536);
  socket.auto_fragment(false);
  socket.binary(true);
}

asio::awaitable<void> accept(WebSocketStream& stream,
                             const beast::http::request<beast::http::empty_body>& upgrade,
                             const std::string& subprotocol, error_code& error) {
  stream.socket.set_option(
      websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
        if (!subprotocol.empty())
          response.set(beast::http::field::sec_websocket_protocol, subprotocol);
        response.set(beast::http::field::server, "hermite");
      }));
  co_await stream.socket.async_accept(upgrade, asio::redirect_error(asio::use_awaitable, error));
}

asio::awaitable<ReadMessage> read_message(WebSocketStream& stream,
                                          const std::function<std::size_t()>& max_bytes) {
  ReadMessage read;
  stream.message.consume(stream.message.size());
  // Beast's own limit would close the connection without a reason.
  do {
    co_await stream.socket.async_read_some(stream.message, kReadBytes,
                                           asio::redirect_error(asio::use_awaitable, read.error));
    if (read.error) co_return read;
    read.too_long = stream.message.size() > max_bytes();
  } while (!read.too_long && !stream.socket.is_message_done());
  read.is_text = stream.socket.got_text();
  co_return read;
}

asio::awaitable<void> write_message(WebSocketStream& stream, const std::string& bytes,
                                    error_code& error) {
  co_await stream.socket.async_write(asio::buffer(bytes),
                                     asio::redirect_error(asio::use_awaitable, error));
}

asio::awaitable<void> write_ping(WebSocketStream& stream, error_code& error) {
  const websocket::ping_data nothing;
  co_await stream.socket.async_ping(nothing, asio::redirect_error(asio::use_awaitable, error));
}

asio::awaitable<void> close(WebSocketStream& stream, std::uint16_t code,
                            const std::string& full_text) {
  const std::string text = wire::without_paths(full_text);
  websocket::close_reason reason;
  reason.code = code;
  // A close frame has room for 123 bytes of reason; truncate it between characters.
  std::size_t length = std::min<std::size_t>(text.size(), 120);
  while (length > 0 && length < text.size() &&
         (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80)
    --length;
  reason.reason = websocket::reason_string(text.data(), length);
  error_code ignored;
  co_await stream.socket.async_close(reason, asio::redirect_error(asio::use_awaitable, ignored));
}

}  // namespace hermite::server
