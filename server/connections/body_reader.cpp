#include "server/connections/body_reader.h"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/read.hpp>
#include <chrono>
#include <string_view>
#include <vector>

#include "server/net/run_on.h"

namespace hermite::server {

namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;

constexpr std::chrono::seconds kPiecePatience(60);
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";

asio::awaitable<bool> say_continue(Transport& stream, const HeaderParser& header) {
  if (header.get()[http::field::expect] != "100-continue") co_return true;
  error_code error;
  stream.next_layer().expires_after(kPiecePatience);
  co_await asio::async_write(stream, asio::buffer(kContinue),
                             asio::redirect_error(asio::use_awaitable, error));
  co_return !error;
}

}  // namespace

asio::awaitable<bool> receive_body(Transport& stream, boost::beast::flat_buffer& buffer,
                                   HeaderParser& header, asio::thread_pool& disk, BodySink& sink) {
  bool open = co_await say_continue(stream, header);
  // A client that resumes this upload need not wait for a dead connection.
  sink.on_unwanted([&stream] { stream.next_layer().cancel(); });
  http::request_parser<http::buffer_body> parser(std::move(header));
  std::vector<char> piece(kBodyPieceBytes);
  error_code error;
  while (open && sink.wanted() && !parser.is_done()) {
    parser.get().body().data = piece.data();
    parser.get().body().size = piece.size();
    stream.next_layer().expires_after(kPiecePatience);
    co_await http::async_read(stream, buffer, parser,
                              asio::redirect_error(asio::use_awaitable, error));
    if (error == http::error::need_buffer) error = {};
    const std::string_view received(piece.data(), piece.size() - parser.get().body().size);
    bool written = true;
    auto write = [&sink, &written, received] { written = sink.write(received).ok(); };
    if (!received.empty()) co_await run_on(disk, write);
    open = !error && written;
  }
  sink.on_unwanted(nullptr);
  const bool complete = open && parser.is_done();
  auto close = [&sink, complete] { sink.close(complete); };
  co_await run_on(disk, close);
  co_return complete;
}

}  // namespace hermite::server
