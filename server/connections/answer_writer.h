// Writes the answer to an HTTP request, with the headers that every answer has. One of the files
// that use Boost.Beast.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/asio/thread_pool.hpp>

#include "server/net/transport.h"
#include "server/routes/http_routes.h"

namespace hermite::server {

// What the request and its connection say about the answer.
struct Answering {
  unsigned int version = 11;
  bool encrypted = false;
  bool head = false;  // send the answer without its body
  bool keep_alive = false;
};

// Returns whether the connection can continue. A stored body is read on `disk`, without which it is
// not sent; it may take any time, as long as the client goes on receiving it. On the thread of
// `stream`, which outlives the writing, as `disk` does.
boost::asio::awaitable<bool> write_answer(Transport& stream, HttpAnswer answer,
                                          const Answering& how, boost::asio::thread_pool* disk);

}  // namespace hermite::server
