// Shows the progress of a streamed scan: one line that is overwritten on a terminal, otherwise a
// plain line every few seconds.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "server/client/stream.h"

namespace hermite::client {

// Returns "frame 42/1000 (sent 46)  2.1 fps  18.3 Mbit/s  position 0.12 -0.03 1.40 m  tracked +-8
// mm  3 dropped  7:36 left", without a line feed. Instead of "tracked": "LOST: too fast - go back
// to what was seen 4 s ago".
std::string format_progress(const StreamProgress& progress);

// Returns the accuracy of the camera's position as twice the standard deviation: " +-8 mm" or " +-2
// cm". Empty if the server does not report it.
std::string within_text(const wire::FrameResult& result);

// Returns what happened to the map in this frame: "frame 420: loop closed: the map was corrected by
// up to 3 cm". Empty if nothing did.
std::string format_event(const wire::FrameResult& result);

// Returns the last line: "scan 4f is finished: 1000 frames sent in 7:36, 998 tracked, 3
// dropped, 18.3 Mbit/s".
std::string format_summary(const StreamProgress& progress);

// Returns for example "59 s", "7:36", "2:05:09".
std::string format_duration(double seconds);

// Writes to a stream that it does not own. One thread.
class ProgressPrinter {
 public:
  ProgressPrinter(std::ostream& out, bool is_terminal) : out_(out), is_terminal_(is_terminal) {}

  // Writes at most 5 times per second on a terminal, otherwise every 5 s, by the clock of
  // `progress`.
  void show(const StreamProgress& progress);
  void show_now(const StreamProgress& progress);
  // The same for any line, by a clock of the caller.
  void show(double now_s, const std::string& text);
  // A separate line, which the progress does not overwrite.
  void line(const std::string& message);

 private:
  bool is_due(double now_s) const;
  void write(double now_s, const std::string& text);
  void clear();

  std::ostream& out_;
  bool is_terminal_;
  bool line_is_open_ = false;
  std::optional<double> shown_at_s_;
};

}  // namespace hermite::client
