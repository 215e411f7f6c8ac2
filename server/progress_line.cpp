#include "server/progress_line.h"

#include <iostream>
#include <utility>

namespace hermite::commands {

void ProgressLine::line(const std::string& message) {
  clear();
  std::cerr << message << std::endl;
}

void ProgressLine::progress(const std::string& message) {
  const Clock::time_point now = Clock::now();
  if (!terminal_ || now - shown_at_ < std::chrono::milliseconds(200)) return;
  shown_at_ = now;
  std::cerr << "\r" << message << "\x1b[K" << std::flush;
  open_ = true;
}

void ProgressLine::clear() {
  if (std::exchange(open_, false)) std::cerr << "\r\x1b[K" << std::flush;
}

}  // namespace hermite::commands
