// Headers of uploads. Input: lines "Name: value".
#include <algorithm>
#include <cstdint>
#include <string>

#include "core/base/check.h"
#include "server/net/base64.h"
#include "server/uploads/tus.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hermite;
  const std::string text(reinterpret_cast<const char*>(data), size);
  server::HttpHeaders headers;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    const std::size_t colon = std::min(line.find(": "), line.size());
    headers.emplace_back(line.substr(0, colon), line.substr(std::min(colon + 2, line.size())));
    at = end + 1;
  }
  const Result<server::TusHeaders> parsed = server::parse_tus_headers(headers);
  CHECK(parsed.ok() || !parsed.error().message.empty(), "an error without words");
  if (!parsed.ok()) return 0;
  CHECK(parsed->length_bytes.value_or(0) >= 0 && parsed->offset_bytes.value_or(0) >= 0,
        "a size below zero");
  CHECK(!parsed->checksum || parsed->checksum->digest.size() >= 20, "a checksum of no algorithm");
  const auto metadata = server::parse_upload_metadata(parsed->metadata);
  CHECK(metadata.ok(), "metadata that was good is not any more");
  for (const auto& [key, value] : *metadata) {
    CHECK(server::decode_base64(server::encode_base64(value)) == value, "base64 there and back");
    CHECK(server::decode_percent(value).size() <= value.size(), "percents make nothing longer");
  }
  return 0;
}
