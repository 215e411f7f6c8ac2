// CHECK(condition, words) is for programming errors: it prints file, line and words, then aborts. Never for invalid
// input.
#pragma once

#include <string>

namespace hermite {
[[noreturn]] void check_failed(const char* file, int line, const char* condition, const std::string& words);
}  // namespace hermite

#define CHECK(condition, words) ((condition) ? static_cast<void>(0) : ::hermite::check_failed(__FILE__, __LINE__, #condition, (words)))
