// Notifies systemd about a service of Type=notify: one datagram to $NOTIFY_SOCKET for each message,
// without libsystemd. Sends nothing if that is not set. One thread.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace hermite::server {

class ServiceManager {
 public:
  // Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID from the environment, which stays
  // unchanged.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  // Sends "READY=1", "STOPPING=1", "WATCHDOG=1" or "STATUS=...". Never blocks and never fails: a
  // message that cannot be sent is dropped.
  void tell(const std::string& message) const;

  // Returns how often to send WATCHDOG=1: half of the time after which the service is considered
  // dead; std::nullopt without a watchdog.
  std::optional<std::chrono::microseconds> watchdog_period() const { return watchdog_period_; }

 private:
  int socket_ = -1;
  std::string address_;  // sun_path; starts with a zero byte if abstract
  std::optional<std::chrono::microseconds> watchdog_period_;
};

}  // namespace hermite::server
