// Which names of archive entries are safe as names of files. Pure.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite::archive {

inline constexpr std::size_t kMaxEntryName_bytes = 512;
// File systems allow 255 bytes; this leaves room for what this program appends.
inline constexpr std::size_t kMaxEntryPart_bytes = 200;
inline constexpr std::size_t kMaxEntryDepth = 8;  // recordings have 2 or 3

// Returns the parts between the slashes without any "."; none for the archive's own folder ("./").
// kInvalidArgument, with a message that names the rule: an absolute path, "..", a backslash, NUL or
// another control character, or more than the limits above.
Result<std::vector<std::string>> safe_entry_parts(std::string_view name);

// For messages: control characters and what is no ASCII as "?", cut to a readable length.
std::string shown_entry_name(std::string_view name);

}  // namespace hermite::archive
