#include "server/net/service_manager.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <memory>

#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

// The other end of $NOTIFY_SOCKET.
class Listener {
 public:
  explicit Listener(const std::string& name)
      : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.data(), name.size());
    if (name[0] == '@') address.sun_path[0] = 0;
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), length), 0);
    setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  ~Listener() {
    close(socket_);
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }
  std::string heard() {
    char text[256];
    const ssize_t count = recv(socket_, text, sizeof text, 0);
    return count > 0 ? std::string(text, static_cast<std::size_t>(count)) : "";
  }

 private:
  int socket_;
};

TEST(ServiceManager, IsToldByDatagram) {
  const test::TemporaryFolder folder;
  for (const std::string& name :
       {std::string(folder / "notify"), "@hermite-test-" + std::to_string(getpid())}) {
    Listener listener(name);
    const ServiceManager manager;
    EXPECT_FALSE(manager.watchdog_period());
    manager.tell("READY=1");
    EXPECT_EQ(listener.heard(), "READY=1") << name;
  }
}

TEST(ServiceManager, TheWatchdogWantsHalfItsTime) {
  Listener listener("@hermite-test-" + std::to_string(getpid()));
  setenv("WATCHDOG_USEC", "30000000", 1);
  EXPECT_EQ(ServiceManager().watchdog_period(), std::chrono::seconds(15));
  setenv("WATCHDOG_PID", "1", 1);
  EXPECT_FALSE(ServiceManager().watchdog_period()) << "of another process";
  setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  EXPECT_TRUE(ServiceManager().watchdog_period());
  setenv("WATCHDOG_USEC", "soon", 1);
  EXPECT_FALSE(ServiceManager().watchdog_period());
}

TEST(ServiceManager, SilenceHarmsNobody) {
  unsetenv("NOTIFY_SOCKET");
  ServiceManager().tell("READY=1");
  setenv("NOTIFY_SOCKET", ("/" + std::string(200, 'x')).c_str(), 1);
  ServiceManager().tell("READY=1");
  setenv("NOTIFY_SOCKET", "/nobody/listens", 1);
  ServiceManager().tell("READY=1");
  unsetenv("NOTIFY_SOCKET");
}

}  // namespace
}  // namespace hermite::server
