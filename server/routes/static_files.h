// The viewer's files, read once at start-up. Requests are looked up by name in this table: no path is ever made from what a client sends.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace hermite {

struct StaticFile {
  std::string content_type;
  bool immutable = false;  // its name changes with its content (Vite's assets/)
  std::string bytes;
};
using StaticFiles = std::map<std::string, StaticFile, std::less<>>;  // by URL path; "/" is index.html

inline constexpr std::size_t kMaxStaticFiles = 4096;
inline constexpr std::size_t kMaxStaticBytes = 256 * 1024 * 1024;

// Regular files below `folder`; links and names with other characters than [A-Za-z0-9._-] are left out.
// kNotFound: no such folder, or no index.html in it. kTooLarge: more than the limits above. kIo: a file that cannot be read.
Result<StaticFiles> read_static_files(const std::string& folder);

// By the ending of the name; "application/octet-stream" when it is not known.
std::string content_type_of(std::string_view name);

}  // namespace hermite
