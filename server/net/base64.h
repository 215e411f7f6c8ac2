// Base64 of RFC 4648 with padding. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace hermite::server {

std::string encode_base64(std::string_view bytes);

// Returns std::nullopt for invalid text. Only one text is accepted for the same bytes.
std::optional<std::string> decode_base64(std::string_view text);

}  // namespace hermite::server
