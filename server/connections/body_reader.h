// Reads a request body that is too long for memory: each piece is read from the socket only when
// the previous one was passed to the disk thread. One of the files that use Boost.Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>

#include "server/net/transport.h"
#include "server/routes/body_sink.h"

namespace hermite::server {

using HeaderParser = boost::beast::http::request_parser<boost::beast::http::empty_body>;

// Memory per connection that sends a body.
inline constexpr std::size_t kBodyPieceBytes = 128 * 1024;

// Passes the body that follows `header` to `sink`, and closes the sink at the end. Consumes
// `header`. Sends 100 Continue to a client that expects it. Returns true if the whole body was
// received and the sink wanted all of it. A piece that takes longer than a minute ends the
// connection: 2 kB/s is too slow for an upload.
boost::asio::awaitable<bool> receive_body(Transport& stream, boost::beast::flat_buffer& buffer,
                                          HeaderParser& header, boost::asio::thread_pool& disk,
                                          BodySink& sink);

}  // namespace hermite::server
