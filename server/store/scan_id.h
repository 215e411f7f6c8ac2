// Names of scans: 26 characters of [a-z0-9], random, so that they can stand in a path and in a URL as they are.
#pragma once

#include <string>
#include <string_view>

namespace hermite {

// From the system's random source: 134 bits. Throws SetupError when there is none.
std::string new_scan_id();

bool is_scan_id(std::string_view text);

// `byte_count` random bytes as lower case hex.
std::string random_hex(int byte_count);

}  // namespace hermite
