// How a client connects a WebSocket to a Hermite server (subprotocol hermite.v1), for everything
// here that has one. One of the files that use Boost.Beast.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "core/base/result.h"
#include "server/client/server_url.h"
#include "server/net/transport.h"

namespace hermite::client {

using ClientSocket = boost::beast::websocket::stream<server::Transport>;

// To be called before connect_socket(): sets time limits, the subprotocol and the limit for a
// received message. `patience` is for each of the handshakes of the WebSocket, at its beginning and
// its end.
void prepare_socket(ClientSocket& socket, std::chrono::milliseconds patience);

// Resolves the name, connects and upgrades to WebSocket. Sets `failure` unless that succeeded;
// errors as Connection::open. A time limit of the lowest layer (expires_after) holds until the
// WebSocket's handshake. All arguments must outlive the coroutine.
boost::asio::awaitable<void> connect_socket(ClientSocket& socket, const ServerUrl& url,
                                            std::optional<Error>& failure);

// Returns why a connection has ended, as text, when reading has failed with `error`.
std::string why_ended(const ClientSocket& socket, const boost::beast::error_code& error);

}  // namespace hermite::client
