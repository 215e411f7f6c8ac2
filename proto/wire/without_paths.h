// The one place that messages for clients go through: what a camera, a viewer or a share link is
// told of an error says what failed and why, and not where on the server's disks. The log keeps all
// of it. Pure functions.
#pragma once

#include <string>

namespace hermite::wire {

// Every absolute path in `message` shortened to its last name: "writing
// /srv/data/scans/x/cloud.ply: No space left on device" becomes "writing cloud.ply: No space left
// on device". Paths of the API ("/api/...") stay.
std::string without_paths(const std::string& message);

}  // namespace hermite::wire
