// Ids of scans: 26 random characters of [a-z0-9], which need no escaping in a path or URL.
#pragma once

#include <string>
#include <string_view>

namespace hermite::server {

// Uses the system's random source: 134 bits. Throws SetupError if it fails.
std::string new_scan_id();

bool is_scan_id(std::string_view text);

// Returns `byte_count` random bytes as lower case hex. Throws as above.
std::string random_hex(int byte_count);

}  // namespace hermite::server
