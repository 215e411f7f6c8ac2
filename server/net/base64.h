// RFC 4648 with its padding. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace hermite {

std::string encode_base64(std::string_view bytes);

// Nothing for what is none; a text that is decoded is the only one for its bytes.
std::optional<std::string> decode_base64(std::string_view text);

}  // namespace hermite
