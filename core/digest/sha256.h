// SHA-256 (FIPS 180-4) of bytes in memory, by OpenSSL. Pure functions.
#pragma once

#include <string>
#include <string_view>

namespace hermite::digest {

std::string sha256(std::string_view bytes);  // 32 bytes
std::string hex(std::string_view bytes);     // two lower case digits for each
std::string sha256_hex(std::string_view bytes);

}  // namespace hermite::digest
