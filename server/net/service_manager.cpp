#include "server/net/service_manager.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace hermite::server {

namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

std::optional<std::int64_t> number(const std::string& text) {
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || value <= 0) return std::nullopt;
  return value;
}

}  // namespace

ServiceManager::ServiceManager() {
  const std::string path = variable("NOTIFY_SOCKET");
  const bool usable = !path.empty() && (path[0] == '/' || path[0] == '@') &&
                      path.size() < sizeof(sockaddr_un::sun_path);
  if (!usable) return;
  address_ = path;
  if (address_[0] == '@') address_[0] = '\0';
  socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const std::string pid = variable("WATCHDOG_PID");
  // Meant for another process.
  if (!pid.empty() && number(pid) != static_cast<std::int64_t>(getpid())) return;
  if (const std::optional<std::int64_t> patience_us = number(variable("WATCHDOG_USEC")))
    watchdog_period_ = std::chrono::microseconds(*patience_us / 2);
}

ServiceManager::~ServiceManager() {
  if (socket_ >= 0) close(socket_);
}

void ServiceManager::tell(const std::string& message) const {
  if (socket_ < 0) return;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, address_.data(), address_.size());
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  // If systemd is gone or its queue is full, nobody can be told.
  [[maybe_unused]] const ssize_t sent =
      sendto(socket_, message.data(), message.size(), MSG_NOSIGNAL,
             reinterpret_cast<const sockaddr*>(&address), length);
}

}  // namespace hermite::server
