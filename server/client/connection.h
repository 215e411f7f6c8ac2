// One WebSocket to a Hermite server (subprotocol hermite.v1), whole binary messages in and out.
//
// Everything happens on the calling thread, inside open() and wait_until(): writing a long message never keeps messages from coming in.
// At most one message is held in either direction; one longer than wire::kMaxServerMessageBytes ends the connection. After `ended()`
// nothing more is sent; messages received before may still be taken.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "server/client/server_url.h"

namespace hermite {

class Connection {
 public:
  // kIo: nobody answers, or not within `patience`. kUnsupported: something answers that is no Hermite server. kUnauthorized: refused before
  // the first message, or a certificate that is not trusted. kInvalidArgument: `ca`, a file with the certificate authorities to believe
  // (PEM) instead of the system's.
  static Result<std::unique_ptr<Connection>> open(const ServerUrl& url, std::chrono::milliseconds patience, const std::string& ca = {});
  ~Connection();  // drops the connection without a word when close() was not called
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool can_send() const;             // nothing is being written, and the connection has not ended
  void send(std::string message);    // CHECKs can_send(); returns at once
  std::uint64_t sent_bytes() const;  // whole messages written

  std::optional<std::string> take_message();

  // Returns at once when the connection has ended or a message can be taken, else after the next event (a message, a message written,
  // the end of the connection, wake()) or at `deadline`.
  void wait_until(std::chrono::steady_clock::time_point deadline);

  // Ends a wait_until() early, now or the next one. From any thread.
  void wake();

  // Why the connection is over, in words; none while it lives.
  const std::optional<Error>& ended() const;

  // The WebSocket closing handshake, at most `patience` long.
  void close(std::chrono::milliseconds patience);

 private:
  struct Impl;
  explicit Connection(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite
