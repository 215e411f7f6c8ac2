#include "server/client/printable.h"

namespace hermite::client {

// In UTF-8 the second range of control characters, U+0080 to U+009F, is 0xc2 and a byte from 0x80
// to 0x9f; 0xc2 alone begins other characters.
std::string printable(const std::string& text) {
  const auto byte = [&text](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
  };
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_pair = byte(i) == 0xc2 && byte(i + 1) >= 0x80 && byte(i + 1) <= 0x9f;
    const bool is_control = is_pair || byte(i) < 0x20 || byte(i) == 0x7f;
    result += is_control ? '?' : text[i];
    if (is_pair) ++i;
  }
  return result;
}

}  // namespace hermite::client
