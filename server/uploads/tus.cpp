#include "server/uploads/tus.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>

namespace hermite::server {

namespace {

// The largest range that JavaScript represents exactly.
constexpr std::int64_t kMaxNumber = std::int64_t{1} << 53;

Error invalid(std::string_view header, const std::string& message) {
  return {ErrorCode::kInvalidArgument, std::string(header) + " " + message};
}

bool same_name(std::string_view a, std::string_view b) {
  const auto lower = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (lower(a[i]) != lower(b[i])) return false;
  return true;
}

// Returns an empty optional if the header is missing.
Result<std::optional<std::string>> only_value(const HttpHeaders& headers, std::string_view name) {
  std::optional<std::string> value;
  for (const auto& [given, text] : headers) {
    if (!same_name(given, name)) continue;
    if (value) return invalid(name, "is there twice");
    value = text;
  }
  return value;
}

Result<std::optional<std::int64_t>> number_in(const HttpHeaders& headers, std::string_view name) {
  const Result<std::optional<std::string>> text = only_value(headers, name);
  if (!text.ok()) return text.error();
  if (!*text) return std::optional<std::int64_t>();
  std::int64_t number = -1;
  const char* const end = (*text)->data() + (*text)->size();
  const auto [stop, error] = std::from_chars((*text)->data(), end, number);
  if (error != std::errc() || stop != end || (*text)->front() == '-' || number > kMaxNumber)
    return invalid(name, fmt::format("is no whole number from 0 to {}", kMaxNumber));
  return std::optional<std::int64_t>(number);
}

Result<std::optional<Checksum>> checksum_in(const HttpHeaders& headers) {
  constexpr std::string_view kName = "Upload-Checksum";
  const Result<std::optional<std::string>> text = only_value(headers, kName);
  if (!text.ok()) return text.error();
  if (!*text) return std::optional<Checksum>();
  const std::size_t space = (*text)->find(' ');
  if (space == std::string::npos) return invalid(kName, "is not ALGORITHM BASE64");
  const std::string algorithm = (*text)->substr(0, space);
  for (const ChecksumAlgorithm known : kAllChecksums) {
    if (algorithm != name_of(known)) continue;
    const std::optional<std::string> digest =
        decode_base64(std::string_view(**text).substr(space + 1));
    const std::size_t size = known == ChecksumAlgorithm::kSha1 ? 20 : 32;
    if (!digest || digest->size() != size)
      return invalid(kName, fmt::format("has no base64 of {} bytes", size));
    return std::optional<Checksum>({known, *digest});
  }
  return Error{ErrorCode::kUnsupported,
               std::string(kName) + " wants another algorithm than sha1 or sha256"};
}

Result<bool> length_follows_in(const HttpHeaders& headers) {
  const Result<std::optional<std::string>> text = only_value(headers, "Upload-Defer-Length");
  if (!text.ok()) return text.error();
  if (*text && **text != "1") return invalid("Upload-Defer-Length", "is not 1");
  return text->has_value();
}

}  // namespace

const char* name_of(ChecksumAlgorithm algorithm) {
  return algorithm == ChecksumAlgorithm::kSha1 ? "sha1" : "sha256";
}

Result<TusHeaders> parse_tus_headers(const HttpHeaders& headers) {
  TusHeaders parsed;
  for (const auto& [name, text] : {std::pair{"Tus-Resumable", &parsed.version},
                                   std::pair{"Upload-Metadata", &parsed.metadata}}) {
    Result<std::optional<std::string>> value = only_value(headers, name);
    if (!value.ok()) return value.error();
    *text = (*value).value_or("");
  }
  for (const auto& [name, number] : {std::pair{"Upload-Length", &parsed.length_bytes},
                                     std::pair{"Upload-Offset", &parsed.offset_bytes}}) {
    const Result<std::optional<std::int64_t>> value = number_in(headers, name);
    if (!value.ok()) return value.error();
    *number = *value;
  }
  const Result<bool> follows = length_follows_in(headers);
  if (!follows.ok()) return follows.error();
  parsed.length_follows = *follows;
  if (parsed.length_follows && parsed.length_bytes)
    return invalid("Upload-Defer-Length", "and Upload-Length do not go together");
  if (const auto metadata = parse_upload_metadata(parsed.metadata); !metadata.ok())
    return metadata.error();
  Result<std::optional<Checksum>> checksum = checksum_in(headers);
  if (!checksum.ok()) return checksum.error();
  parsed.checksum = *std::move(checksum);
  const Result<std::optional<std::string>> type = only_value(headers, "Content-Type");
  if (!type.ok()) return type.error();
  parsed.is_piece = *type && **type == kTusContentType;
  return parsed;
}

Result<std::map<std::string, std::string>> parse_upload_metadata(std::string_view header) {
  constexpr std::string_view kName = "Upload-Metadata";
  std::map<std::string, std::string> values;
  if (header.size() > kMaxMetadataBytes)
    return invalid(kName,
                   fmt::format("has {} bytes, allowed are {}", header.size(), kMaxMetadataBytes));
  while (!header.empty()) {
    const std::size_t comma = std::min(header.find(','), header.size());
    std::string_view pair = header.substr(0, comma);
    header.remove_prefix(std::min(comma + 1, header.size()));
    while (!pair.empty() && pair.front() == ' ') pair.remove_prefix(1);
    while (!pair.empty() && pair.back() == ' ') pair.remove_suffix(1);
    const std::size_t space = std::min(pair.find(' '), pair.size());
    const std::string key(pair.substr(0, space));
    for (const char c : key)
      if (c <= 0x20 || c >= 0x7f) return invalid(kName, "has a key that is no printable ASCII");
    if (key.empty()) return invalid(kName, "has an empty key");
    const std::optional<std::string> value =
        decode_base64(pair.substr(std::min(space + 1, pair.size())));
    if (!value) return invalid(kName, fmt::format("has a value of {} that is no base64", key));
    if (!values.emplace(key, *value).second)
      return invalid(kName, fmt::format("has the key {} twice", key));
    if (values.size() > kMaxMetadataKeys)
      return invalid(kName, fmt::format("has more than {} keys", kMaxMetadataKeys));
  }
  return values;
}

std::string decode_percent(std::string_view text) {
  std::string decoded;
  for (std::size_t at = 0; at < text.size(); ++at) {
    unsigned int value = 0;
    const char* const digits = text.data() + at + 1;
    const bool coded = text[at] == '%' && at + 2 < text.size() &&
                       std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2;
    decoded += coded ? static_cast<char>(value) : text[at];
    if (coded) at += 2;
  }
  return decoded;
}

}  // namespace hermite::server
