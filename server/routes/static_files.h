// The viewer's files, read once at start-up. Requests are looked up by name in this table: no path
// is ever built from what a client sends.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace hermite::server {

struct StaticFile {
  std::string content_type;
  bool immutable = false;  // its name changes with its content (Vite's assets/)
  std::string bytes;
};
// By URL path; "/" is index.html.
using StaticFiles = std::map<std::string, StaticFile, std::less<>>;

inline constexpr std::size_t kMaxStaticFiles = 4096;
inline constexpr std::size_t kMaxStaticBytes = 256 * 1024 * 1024;

// Reads the regular files below `folder`; skips links and names with characters other than
// [A-Za-z0-9._-]. kNotFound: no such folder, or no index.html in it. kTooLarge: more than the
// limits above. kIo: a file that cannot be read.
Result<StaticFiles> read_static_files(const std::string& folder);

// Returns the type for the extension of the name; "application/octet-stream" if it is unknown.
std::string content_type_of(std::string_view name);

}  // namespace hermite::server
