// What systemd is told of a service of Type=notify: one datagram to $NOTIFY_SOCKET for each word, without libsystemd. Where nobody listens
// nothing is sent. One thread.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace hermite {

class ServiceManager {
 public:
  // Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID from the environment and leaves them there.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  // "READY=1", "STOPPING=1", "WATCHDOG=1", "STATUS=...". Never blocks and never fails: what cannot be told is not told.
  void tell(const std::string& words) const;

  // How often to tell WATCHDOG=1: half of the time after which the service is taken for dead. None: nobody waits for it.
  std::optional<std::chrono::microseconds> watchdog_period() const { return watchdog_period_; }

 private:
  int socket_ = -1;
  std::string address_;  // sun_path, with a zero byte first when abstract
  std::optional<std::chrono::microseconds> watchdog_period_;
};

}  // namespace hermite
