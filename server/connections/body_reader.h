// Reads a body that is too long for memory: the next piece comes from the socket when the last one is on its way to the disk. One of the
// places that know Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>

#include "server/net/transport.h"
#include "server/routes/body_sink.h"

namespace hermite {

using HeaderParser = boost::beast::http::request_parser<boost::beast::http::empty_body>;

inline constexpr std::size_t kBodyPieceBytes = 128 * 1024;  // in memory for each connection that sends a body

// Everything behind `header`, which is used up, goes to `sink`, which is closed at the end. Says 100 Continue to a client that waits for
// it. True: all of it has come and was wanted. A piece that takes longer than a minute is the end: 2 kB a second is no upload.
boost::asio::awaitable<bool> receive_body(Transport& stream, boost::beast::flat_buffer& buffer, HeaderParser& header,
                                          boost::asio::thread_pool& disk, BodySink& sink);

}  // namespace hermite
