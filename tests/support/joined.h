// Remarks and doubts as one text, for matchers. Header only.
#pragma once

#include <string>
#include <vector>

namespace hermite::test {

// Each ends with a newline.
inline std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace hermite::test
