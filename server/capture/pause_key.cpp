#include "server/capture/pause_key.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>

namespace hermite::client {

PauseKey::PauseKey() {
  termios now{};
  if (isatty(STDIN_FILENO) == 0 || tcgetpgrp(STDIN_FILENO) != getpgrp() ||
      tcgetattr(STDIN_FILENO, &now) != 0)
    return;
  before_ = now;
  now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(STDIN_FILENO, TCSANOW, &now);
}

PauseKey::~PauseKey() {
  if (before_) tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

int PauseKey::presses() {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  if (!before_ || poll(&input, 1, 0) <= 0 || (input.revents & POLLIN) == 0) return 0;
  char keys[64];
  const ssize_t count = read(STDIN_FILENO, keys, sizeof keys);
  return count > 0 ? static_cast<int>(std::count(keys, keys + count, ' ')) : 0;
}

}  // namespace hermite::client
