// Secrets that grant access: generated here, never logged, stored as SHA-256. One plain round is
// enough for random secrets; slow hashes protect secrets that people choose.
#pragma once

#include <string>
#include <string_view>

namespace hermite::server {

// Prefixes of secrets, so that one that leaked into a file or a repository can be searched for.
inline constexpr std::string_view kTokenPrefix = "hmt_";
inline constexpr std::string_view kSharePrefix = "hms_";

// Returns the prefix followed by 256 random bits as 64 hex digits.
std::string new_secret(std::string_view prefix);

}  // namespace hermite::server
