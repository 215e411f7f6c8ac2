// The link to the server: one connection after another. One thread, except wake().
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/client/connection.h"
#include "server/client/server_url.h"

namespace hermite::client {

class Link {
 public:
  // `server` outlives this. `ca`: as in Connection::open.
  explicit Link(const ServerUrl& server, std::string ca = {})
      : server_(server), ca_(std::move(ca)) {}
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  // Replaces the connection by a new one. Errors as Connection::open; then there is no connection.
  Status open(std::chrono::milliseconds patience);
  void close(std::chrono::milliseconds patience);

  // Only after open() has succeeded.
  Connection& connection() {
    CHECK(connection_, "there is no connection");
    return *connection_;
  }

  void wake();  // as Connection::wake(), for the current connection. From any thread.

  std::uint64_t sent_bytes() const;  // of all connections

  // Sends a ping if one is due and nothing else is being sent.
  void ping(std::chrono::steady_clock::time_point now);
  void answered(const wire::Pong& pong);
  // Returns the round-trip time of the last answered ping.
  std::optional<double> round_trip_ms() const { return round_trip_ms_; }

 private:
  void replace(std::unique_ptr<Connection> connection);

  const ServerUrl& server_;
  const std::string ca_;
  std::mutex mutex_;  // guards replacing the connection against wake()
  std::unique_ptr<Connection> connection_;
  std::uint64_t sent_bytes_before_ = 0;
  std::uint64_t ping_count_ = 0;
  std::chrono::steady_clock::time_point pinged_at_;
  std::optional<double> round_trip_ms_;
};

}  // namespace hermite::client
