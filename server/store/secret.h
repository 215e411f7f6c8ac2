// Secrets that let someone in: made here, never written to a log, kept as SHA-256. One plain round is right for what nobody can guess:
// a slow hash protects what people make up.
#pragma once

#include <string>
#include <string_view>

namespace hermite {

// What they begin with, so that a secret that leaked into a file or a repository can be searched for.
inline constexpr std::string_view kTokenPrefix = "hmt_";
inline constexpr std::string_view kSharePrefix = "hms_";

// The prefix and 256 random bits as 64 hex digits.
std::string new_secret(std::string_view prefix);

}  // namespace hermite
