#include "server/store/scan_id.h"

#include <sys/random.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/base/result.h"
#include "core/digest/sha256.h"

namespace hermite::server {

namespace {

constexpr std::size_t kLength = 26;
constexpr std::string_view kAlphabet = "abcdefghijklmnopqrstuvwxyz0123456789";

std::vector<std::uint8_t> random_bytes(std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  // getrandom() never returns fewer than requested up to 256 bytes once the source is seeded.
  if (count > 256 || getrandom(bytes.data(), count, 0) != static_cast<ssize_t>(count))
    throw SetupError({ErrorCode::kIo, "the system gave no random bytes (getrandom)"});
  return bytes;
}

}  // namespace

std::string new_scan_id() {
  std::string id;
  while (id.size() < kLength) {
    for (const std::uint8_t byte : random_bytes(64)) {
      // 252 is the largest multiple of 36 below 256; higher values would favour the first letters.
      if (byte >= 252 || id.size() == kLength) continue;
      id += kAlphabet[byte % kAlphabet.size()];
    }
  }
  return id;
}

bool is_scan_id(std::string_view text) {
  return text.size() == kLength && std::all_of(text.begin(), text.end(), [](char c) {
           return kAlphabet.find(c) != std::string_view::npos;
         });
}

std::string random_hex(int byte_count) {
  const std::vector<std::uint8_t> bytes = random_bytes(static_cast<std::size_t>(byte_count));
  return digest::hex({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace hermite::server
