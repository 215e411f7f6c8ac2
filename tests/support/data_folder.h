// Where the recorded test sequences lie: $HERMITE_DATA, else ../shared/data beside the source tree.
// Header only.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/source_root/source_root.h"

namespace hermite::test {

// The folder of that sequence, or nothing: the test then calls GTEST_SKIP() << skip_message(name).
inline std::optional<std::filesystem::path> data_folder(const std::string& sequence) {
  const char* stated = std::getenv("HERMITE_DATA");
  const std::filesystem::path folder =
      (stated != nullptr ? std::filesystem::path(stated) : source_root() / "../shared/data") /
      sequence;
  if (!std::filesystem::is_directory(folder)) return std::nullopt;
  return folder;
}

inline std::string skip_message(const std::string& sequence) {
  return "no recorded sequence '" + sequence + "': set HERMITE_DATA to the folder that holds it";
}

}  // namespace hermite::test
