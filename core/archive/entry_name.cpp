#include "core/archive/entry_name.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/base/utf8.h"

namespace hermite::archive {
namespace {

Error refused(std::string_view name, const std::string& reason) {
  return {ErrorCode::kInvalidArgument,
          fmt::format("the name \"{}\" {}", shown_entry_name(name), reason)};
}

}  // namespace

Result<std::vector<std::string>> safe_entry_parts(std::string_view name) {
  if (name.empty()) return refused(name, "is empty");
  if (name.size() > kMaxEntryName_bytes)
    return refused(name,
                   fmt::format("has {} bytes, allowed are {}", name.size(), kMaxEntryName_bytes));
  if (std::any_of(name.begin(), name.end(), is_control))
    return refused(name, "has a control character");
  if (name.find('\\') != std::string_view::npos) return refused(name, "has a backslash");
  if (name.front() == '/') return refused(name, "is an absolute path");
  std::vector<std::string> parts;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find('/'), name.size());
    const std::string part(name.substr(0, end));
    name.remove_prefix(std::min(end + 1, name.size()));
    if (part.empty() || part == ".") continue;
    if (part == "..") return refused(part, "leads out of the folder");
    if (part.size() > kMaxEntryPart_bytes)
      return refused(part,
                     fmt::format("has {} bytes, allowed are {}", part.size(), kMaxEntryPart_bytes));
    if (parts.size() == kMaxEntryDepth)
      return refused(part, fmt::format("lies more than {} folders deep", kMaxEntryDepth - 1));
    parts.push_back(part);
  }
  return parts;
}

std::string shown_entry_name(std::string_view name) {
  constexpr std::size_t kReadable = 100;
  std::string shown(name.substr(0, kReadable));
  for (char& letter : shown)
    if (is_control(letter) || static_cast<unsigned char>(letter) >= 0x80) letter = '?';
  return name.size() > kReadable ? shown + "..." : shown;
}

}  // namespace hermite::archive
