#pragma once

namespace hermite::test {

// True in programs that the address sanitizer watches, where a test takes ten times as long. A test of minutes whose ways through the code
// another test takes, too, is skipped there: the sanitizer would learn nothing from it, and the numbers are checked without it.
#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif

}  // namespace hermite::test
