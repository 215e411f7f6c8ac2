#include "server/store/blobs.h"

#include <fmt/core.h>

#include <algorithm>

namespace hermite::server {

bool is_blob_name(std::string_view name) {
  constexpr std::size_t kMaxLength = 64;
  constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyz0123456789._-";
  if (name.empty() || name.size() > kMaxLength || name.ends_with(".tmp")) return false;
  return name.front() >= 'a' && name.front() <= 'z' &&
         name.find_first_not_of(kAllowed) == std::string_view::npos;
}

Result<std::string> read_blob(Blobs& blobs, const std::string& scan_id, const std::string& name,
                              std::size_t max_bytes) {
  const Result<std::uint64_t> size_bytes = blobs.size_bytes(scan_id, name);
  if (!size_bytes.ok()) return size_bytes.error();
  if (*size_bytes > max_bytes)
    return Error{ErrorCode::kTooLarge, fmt::format("{} of scan {} has {} bytes, allowed are {}",
                                                   name, scan_id, *size_bytes, max_bytes)};
  return blobs.read(scan_id, name, 0, *size_bytes);
}

}  // namespace hermite::server
