#include "server/store/secret.h"

#include <openssl/evp.h>

#include "core/base/check.h"
#include "server/store/scan_id.h"

namespace hermite {

namespace {
constexpr int kSecretBytes = 32;
constexpr std::size_t kHashBytes = 32;
}  // namespace

std::string new_secret(std::string_view prefix) { return std::string(prefix) + random_hex(kSecretBytes); }

std::string sha256(std::string_view text) {
  unsigned char hash[EVP_MAX_MD_SIZE];
  unsigned int length = 0;
  const bool hashed = EVP_Digest(text.data(), text.size(), hash, &length, EVP_sha256(), nullptr) == 1;
  CHECK(hashed && length == kHashBytes, "SHA-256 is part of every OpenSSL");
  return {reinterpret_cast<const char*>(hash), length};
}

}  // namespace hermite
