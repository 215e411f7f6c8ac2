#include "server/connections/answer_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <string>

#include "server/net/run_on.h"
#include "server/store/http_date.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;

// Time without progress while an answer is written.
constexpr std::chrono::seconds kAnswerPatience(60);
constexpr std::size_t kStoredPieceBytes = 256 * 1024;

template <class Response>
void set_headers(Response& response, const HttpAnswer& answer, bool encrypted, bool keep_alive) {
  response.set(http::field::server, "hermite");
  // A server with a clock must say what it shows (RFC 9110, 6.6.1): a page whose computer has
  // another time knows by it for how long a scan has been running.
  response.set(http::field::date, http_date(unix_now_ms()));
  if (encrypted) response.set(http::field::strict_transport_security, "max-age=31536000");
  response.set(http::field::content_type, answer.content_type);
  response.set(http::field::cache_control, answer.cache_control);
  // The viewer's Draco decoder is WebAssembly in a worker; nothing is loaded from other origins.
  // Textures inside a mesh are blobs made by the page, which three.js fetches.
  response.set("Content-Security-Policy",
               "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; "
               "connect-src 'self' blob:; style-src 'self'; "
               "img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; form-action "
               "'none'; frame-ancestors " +
                   answer.frame_ancestors);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  if (!answer.download_name.empty())
    response.set(http::field::content_disposition,
                 fmt::format("attachment; filename=\"{}\"", answer.download_name));
  for (const auto& [name, value] : answer.headers) response.set(name, value);
  if (!answer.allow.empty()) response.set(http::field::allow, answer.allow);
  if (answer.retry_after_s > 0)
    response.set(http::field::retry_after, std::to_string(answer.retry_after_s));
  if (answer.status == 401) response.set(http::field::www_authenticate, "Bearer");
  response.keep_alive(keep_alive);
}

// Writes piece by piece, so that the timeout applies to progress and not to the whole of a large
// cloud.
asio::awaitable<bool> write_stored(Transport& stream, const StoredBody& body,
                                   asio::thread_pool& disk) {
  error_code error;
  for (std::uint64_t sent = 0; !error && sent < body.size_bytes;) {
    Result<std::string> piece = std::string();
    auto read = [&] { piece = body.read(body.first_byte + sent, kStoredPieceBytes); };
    co_await run_on(disk, read);
    // The file was deleted meanwhile: end the connection.
    if (!piece.ok() || piece->empty()) co_return false;
    piece->resize(
        static_cast<std::size_t>(std::min<std::uint64_t>(piece->size(), body.size_bytes - sent)));
    stream.next_layer().expires_after(kAnswerPatience);
    co_await asio::async_write(stream, asio::buffer(*piece),
                               asio::redirect_error(asio::use_awaitable, error));
    sent += piece->size();
  }
  co_return !error;
}

asio::awaitable<bool> write_stored_answer(Transport& stream, const HttpAnswer& answer,
                                          const Answering& how, asio::thread_pool& disk) {
  http::response<http::empty_body> response{static_cast<http::status>(answer.status), how.version};
  set_headers(response, answer, how.encrypted, how.keep_alive);
  response.content_length(answer.stored->size_bytes);
  http::response_serializer<http::empty_body> serializer(response);
  error_code error;
  stream.next_layer().expires_after(kAnswerPatience);
  co_await http::async_write_header(stream, serializer,
                                    asio::redirect_error(asio::use_awaitable, error));
  if (error || how.head) co_return !error;
  co_return co_await write_stored(stream, *answer.stored, disk);
}

}  // namespace

asio::awaitable<bool> write_answer(Transport& stream, HttpAnswer answer, const Answering& how,
                                   asio::thread_pool* disk) {
  if (answer.stored && disk) {
    const bool written = co_await write_stored_answer(stream, answer, how, *disk);
    co_return written&& how.keep_alive;
  }
  const bool keep_alive = how.keep_alive && answer.status < 400;
  http::response<http::string_body> response{static_cast<http::status>(answer.status), how.version};
  set_headers(response, answer, how.encrypted, keep_alive);
  if (answer.status != 204) response.content_length(answer.body.size());
  if (!how.head) response.body() = std::move(answer.body);
  error_code error;
  stream.next_layer().expires_after(kAnswerPatience);
  co_await http::async_write(stream, response, asio::redirect_error(asio::use_awaitable, error));
  co_return !error && keep_alive;
}

}  // namespace hermite::server
