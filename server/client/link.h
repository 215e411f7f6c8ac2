// The way to the server: one connection after the other. Everything but wake() from one thread.
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

namespace hermite {

class Link {
 public:
  // `server` outlives this. `ca`: as in Connection::open.
  explicit Link(const ServerUrl& server, std::string ca = {}) : server_(server), ca_(std::move(ca)) {}
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  // A new connection instead of the one before. Errors as Connection::open; there is none then.
  Status open(std::chrono::milliseconds patience);
  void close(std::chrono::milliseconds patience);

  // After an open() that went well.
  Connection& connection() {
    CHECK(connection_, "there is no connection");
    return *connection_;
  }

  void wake();  // as Connection::wake(), whichever connection there is. From any thread.

  std::uint64_t sent_bytes() const;  // over all connections

  // Sends a ping when one is due and nothing else is being sent.
  void ping(std::chrono::steady_clock::time_point now);
  void answered(const wire::Pong& pong);
  std::optional<double> round_trip_ms() const { return round_trip_ms_; }  // of the last ping that was answered

 private:
  void replace(std::unique_ptr<Connection> connection);

  const ServerUrl& server_;
  const std::string ca_;
  std::mutex mutex_;  // only for wake(): who replaces the connection, and who wakes it
  std::unique_ptr<Connection> connection_;
  std::uint64_t sent_bytes_before_ = 0;
  std::uint64_t ping_count_ = 0;
  std::chrono::steady_clock::time_point pinged_at_;
  std::optional<double> round_trip_ms_;
};

}  // namespace hermite
