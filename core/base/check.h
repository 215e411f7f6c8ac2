// CHECK(condition, message) is for programming errors: it prints file, line and message, then
// aborts. Never for invalid input.
#pragma once

#include <string>

namespace hermite {
[[noreturn]] void check_failed(const char* file, int line, const char* condition,
                               const std::string& message);
}  // namespace hermite

#define CHECK(condition, message)     \
  ((condition) ? static_cast<void>(0) \
               : ::hermite::check_failed(__FILE__, __LINE__, #condition, (message)))
