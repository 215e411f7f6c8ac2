// The progress of a scan for the person with the camera: one line, with what matters while walking
// on the left. Pure functions.
#pragma once

#include <string>

#include "server/capture/scan.h"

namespace hermite::client {

// Returns for example "0:42  29.9 fps  81 % depth  tracked  0.3 s behind  18.3 Mbit/s  round trip
// 12 ms  3 dropped". Times count from the start of the scan, also in the hint of where to return
// to: "LOST: too fast - go back to what was seen at 0:39". With a recording, also how many frames
// are durable on the server, and how far behind that is. No line feed.
std::string format_scan_progress(const ScanProgress& progress);

// Returns the last line: frames, drops, where the recording is, and the server's result.
std::string format_scan_summary(const ScanProgress& progress, const std::string& record_folder);

}  // namespace hermite::client
