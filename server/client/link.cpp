#include "server/client/link.h"

#include <utility>

#include "proto/wire/client_message.h"

namespace hermite::client {

namespace {

constexpr std::chrono::seconds kPingPeriod(2);

}  // namespace

void Link::replace(std::unique_ptr<Connection> connection) {
  if (connection_) sent_bytes_before_ += connection_->sent_bytes();
  const std::lock_guard lock(mutex_);
  connection_ = std::move(connection);
}

Status Link::open(std::chrono::milliseconds patience) {
  replace(nullptr);
  auto connection = Connection::open(server_, patience, ca_);
  if (!connection.ok()) return connection.error();
  replace(*std::move(connection));
  pinged_at_ = std::chrono::steady_clock::now();
  return Done{};
}

void Link::close(std::chrono::milliseconds patience) {
  if (connection_) connection_->close(patience);
}

void Link::wake() {
  const std::lock_guard lock(mutex_);
  if (connection_) connection_->wake();
}

std::uint64_t Link::sent_bytes() const {
  return sent_bytes_before_ + (connection_ ? connection_->sent_bytes() : 0);
}

void Link::ping(std::chrono::steady_clock::time_point now) {
  if (now - pinged_at_ < kPingPeriod || !connection_->can_send()) return;
  connection_->send(wire::format_client_message(wire::Ping{++ping_count_}));
  pinged_at_ = now;
}

void Link::answered(const wire::Pong& pong) {
  if (pong.id != ping_count_) return;
  round_trip_ms_ =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - pinged_at_)
          .count();
}

}  // namespace hermite::client
