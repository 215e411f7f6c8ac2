// A file of a format that has several, by its name in their folder. Plain value.
#pragma once

#include <string>
#include <vector>

namespace hermite::output {

struct NamedFile {
  std::string name;  // letters, digits, '.', '_' and '-', because other programs split at spaces
  std::string bytes;
};
using NamedFiles = std::vector<NamedFile>;

}  // namespace hermite::output
