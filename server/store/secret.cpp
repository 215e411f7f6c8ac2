#include "server/store/secret.h"

#include "server/store/scan_id.h"

namespace hermite::server {

namespace {
constexpr int kSecretBytes = 32;
}  // namespace

std::string new_secret(std::string_view prefix) {
  return std::string(prefix) + random_hex(kSecretBytes);
}

}  // namespace hermite::server
