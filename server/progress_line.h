// A line of progress on stderr, which is overwritten on a terminal and left out elsewhere, and
// separate lines for lasting messages.
#pragma once

#include <chrono>
#include <string>

namespace hermite::commands {

class ProgressLine {
 public:
  explicit ProgressLine(bool terminal) : terminal_(terminal) {}

  // Writes a message that stays, in place of the progress.
  void line(const std::string& message);
  // Overwrites the progress, five times a second at most.
  void progress(const std::string& message);
  // Removes the progress.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  const bool terminal_;
  bool open_ = false;
  Clock::time_point shown_at_{};
};

}  // namespace hermite::commands
