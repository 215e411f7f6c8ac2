// Text in UTF-8 (RFC 3629). Pure functions.
#pragma once

#include <cstddef>
#include <string>

namespace hermite {

// Returns the length in bytes of the character at `at`; 0: it is not valid UTF-8.
std::size_t utf8_length(const std::string& text, std::size_t at);

// Returns the text with U+FFFD in place of each byte that is not UTF-8, and of each NUL.
std::string readable_utf8(const std::string& text);

// Returns whether it is one of the control characters of ASCII, such as a newline.
inline bool is_control(char character) {
  return static_cast<unsigned char>(character) < 0x20 || character == 0x7f;
}

}  // namespace hermite
