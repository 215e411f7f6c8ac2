// Shows on a terminal what a server is doing. Pure function.
#pragma once

#include <cstddef>
#include <string>

#include "server/client/activity.h"

namespace hermite::client {

// In characters; 0: unlimited.
struct TerminalSize {
  std::size_t columns = 0, rows = 0;
};

// Returns a line about the server, one about its load, and tables of the scans and the jobs. Lines
// end with a line feed, are cut to the columns, and where there are too many rows for the size the
// last one says how many are missing. `server`: its name; `now`: a time of day. Control characters
// in what the server says are replaced.
std::string activity_text(const Activity& activity, const std::string& server,
                          const std::string& now, const TerminalSize& size);

}  // namespace hermite::client
