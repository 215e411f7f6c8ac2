// printf into a string, for lines of text. Header only.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace hermite {

// Truncates after 255 bytes; no line of a terminal or table is longer.
__attribute__((format(printf, 1, 2))) inline std::string printf_text(const char* pattern, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

}  // namespace hermite
