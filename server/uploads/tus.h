// Parses the headers of resumable uploads by tus 1.0.0 (https://tus.io/protocols/resumable-upload).
// Pure functions.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "server/net/base64.h"

namespace hermite::server {

inline constexpr const char* kTusVersion = "1.0.0";
inline constexpr const char* kTusExtensions =
    "creation,creation-with-upload,creation-defer-length,checksum,expiration,termination";
inline constexpr const char* kTusContentType = "application/offset+octet-stream";
inline constexpr std::size_t kMaxMetadataBytes = 4096;  // length of the header
inline constexpr std::size_t kMaxMetadataKeys = 16;

// As received; a repeated name has all its values.
using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

enum class ChecksumAlgorithm { kSha1, kSha256 };
inline constexpr ChecksumAlgorithm kAllChecksums[] = {ChecksumAlgorithm::kSha1,
                                                      ChecksumAlgorithm::kSha256};
const char* name_of(ChecksumAlgorithm algorithm);  // "sha1", "sha256"

struct Checksum {
  ChecksumAlgorithm algorithm = ChecksumAlgorithm::kSha1;
  std::string digest;  // 20 or 32 bytes
};

struct TusHeaders {
  std::string version;                       // Tus-Resumable; empty: none
  std::optional<std::int64_t> length_bytes;  // Upload-Length
  std::optional<std::int64_t> offset_bytes;  // Upload-Offset
  bool length_follows = false;               // Upload-Defer-Length: 1
  std::string metadata;                      // Upload-Metadata, accepted by parse_upload_metadata()
  std::optional<Checksum> checksum;          // Upload-Checksum
  bool is_piece = false;                     // Content-Type is kTusContentType
};

// kInvalidArgument, naming header and limit: not a number from 0 to 2^53, invalid base64, a
// repeated header, ... kUnsupported: an unknown checksum algorithm.
Result<TusHeaders> parse_tus_headers(const HttpHeaders& headers);

// Parses "key base64,key base64,key": keys without spaces and commas, each once, in any order.
// Errors as above.
Result<std::map<std::string, std::string>> parse_upload_metadata(std::string_view header);

// Decodes percent-encoding (%20) in a path; a % that two hex digits do not follow remains.
std::string decode_percent(std::string_view text);

}  // namespace hermite::server
