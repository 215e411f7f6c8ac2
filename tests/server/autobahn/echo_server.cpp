// Says back every message, text or binary, over the WebSocket code that the server's sessions stand
// on (websocket_stream.h). For the Autobahn testsuite, which wants an echo; the product has no such
// route. Prints its port, serves until it is killed.
#include <utility>  // before asio/awaitable.hpp, see websocket.h

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/http.hpp>
#include <functional>
#include <iostream>
#include <string>

#include "server/connections/websocket_stream.h"

namespace hermite {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::size_t kMaxBytes = 64 * 1024 * 1024;  // the suite's longest message has 16 MiB
constexpr std::uint16_t kTooBig = 1009;

asio::awaitable<void> echo(tcp::socket socket) {
  server::Transport transport(beast::tcp_stream(std::move(socket)), nullptr);
  beast::flat_buffer buffer;
  http::request_parser<http::empty_body> parser;
  error_code error;
  co_await http::async_read_header(transport, buffer, parser,
                                   asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return;
  const http::request<http::empty_body> upgrade = parser.release();
  server::WebSocketStream stream(std::move(transport), server::WebSocketTimes{});
  const std::string no_subprotocol;
  co_await server::accept(stream, upgrade, no_subprotocol, error);
  const std::function<std::size_t()> max_bytes = [] { return kMaxBytes; };
  while (!error) {
    const server::ReadMessage read = co_await server::read_message(stream, max_bytes);
    if (read.error) co_return;
    if (read.too_long) {
      const std::string message = "the message is too long";
      co_await server::close(stream, kTooBig, message);
      co_return;
    }
    stream.socket.text(read.is_text);
    const std::string message(stream.bytes());
    co_await server::write_message(stream, message, error);
  }
}

asio::awaitable<void> accept_all(tcp::acceptor& acceptor) {
  for (;;) {
    error_code error;
    tcp::socket socket =
        co_await acceptor.async_accept(asio::redirect_error(asio::use_awaitable, error));
    if (!error) asio::co_spawn(acceptor.get_executor(), echo(std::move(socket)), asio::detached);
  }
}

}  // namespace
}  // namespace hermite

int main() {
  boost::asio::io_context context{1};
  boost::asio::ip::tcp::acceptor acceptor(context, {boost::asio::ip::address_v4::loopback(), 0});
  std::cout << acceptor.local_endpoint().port() << std::endl;
  boost::asio::co_spawn(context, hermite::accept_all(acceptor), boost::asio::detached);
  context.run();
}
