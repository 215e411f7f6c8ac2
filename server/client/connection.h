// One WebSocket to a Hermite server (subprotocol hermite.v1); sends and receives whole binary
// messages.
//
// Everything happens on the calling thread, inside open() and wait_until(): messages are received
// while a long one is written. At most one message is held in each direction; a received one longer
// than wire::kMaxServerMessageBytes ends the connection. After `ended()` nothing more is sent;
// messages received before may still be taken.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "server/client/server_url.h"

namespace hermite::client {

class Connection {
 public:
  // kIo: no answer, or not within `patience`. kUnsupported: the answer is not that of a Hermite
  // server. kUnauthorized: refused before the first message, or the certificate is not trusted.
  // kInvalidArgument: `ca`, a file with the certificate authorities to trust (PEM) instead of the
  // system's.
  static Result<std::unique_ptr<Connection>> open(const ServerUrl& url,
                                                  std::chrono::milliseconds patience,
                                                  const std::string& ca = {});
  ~Connection();  // closes the socket without a closing handshake if close() was not called
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool can_send() const;             // nothing is being written, and the connection has not ended
  void send(std::string message);    // CHECKs can_send(); returns immediately
  std::uint64_t sent_bytes() const;  // of whole messages

  std::optional<std::string> take_message();

  // Returns immediately if the connection has ended or a message can be taken, otherwise after the
  // next event (a message received, a message written, the end of the connection, wake()) or at
  // `deadline`.
  void wait_until(std::chrono::steady_clock::time_point deadline);

  // Ends the current or the next wait_until() early. From any thread.
  void wake();

  // Returns why the connection has ended, as text; std::nullopt while it is open.
  const std::optional<Error>& ended() const;

  // Performs the closing handshake of WebSocket, for at most `patience`.
  void close(std::chrono::milliseconds patience);

 private:
  struct Impl;
  explicit Connection(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite::client
