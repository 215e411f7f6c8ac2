// Detects presses of the space bar, without Enter, on the terminal from which this program was
// started. POSIX terminals.
#pragma once

#include <termios.h>

#include <optional>

namespace hermite::client {

// Ctrl-C remains a signal. The destructor restores the terminal. Does nothing if standard input is
// not a terminal, or the program was put into the background. One thread at a time.
class PauseKey {
 public:
  PauseKey();
  ~PauseKey();
  PauseKey(const PauseKey&) = delete;
  PauseKey& operator=(const PauseKey&) = delete;

  // Never waits. Returns the number of presses since the last call.
  int presses();

 private:
  std::optional<termios> before_;
};

}  // namespace hermite::client
