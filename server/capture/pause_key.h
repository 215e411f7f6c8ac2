// The space bar of the terminal that this program was started from, pressed without Enter. POSIX terminals.
#pragma once

#include <termios.h>

#include <optional>

namespace hermite {

// Ctrl-C stays a signal. The terminal is as it was when this goes; where standard input is no terminal, or the program was put into the
// background, nothing happens at all. One thread at a time.
class PauseKey {
 public:
  PauseKey();
  ~PauseKey();
  PauseKey(const PauseKey&) = delete;
  PauseKey& operator=(const PauseKey&) = delete;

  // Never waits. How often it was pressed since the last call.
  int presses();

 private:
  std::optional<termios> before_;
};

}  // namespace hermite
