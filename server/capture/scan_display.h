// What the person with the camera reads: one line, from left to right what matters while walking. Pure functions.
#pragma once

#include <string>

#include "server/capture/scan.h"

namespace hermite {

// "0:42  29.9 fps  81 % depth  tracked  0.3 s behind  18.3 Mbit/s  round trip 12 ms  3 dropped". The clock is the scan's own, and what a
// lost camera is sent back to is told by it: "LOST: too fast - go back to what was seen at 0:39". With a recording also what of it is on
// the server for good, and how many frames that is behind. No line feed.
std::string format_scan_progress(const ScanProgress& progress);

// The last line: frames, drops, where the recording is, what the server made of it.
std::string format_scan_summary(const ScanProgress& progress, const std::string& record_folder);

}  // namespace hermite
