// A file of a format that takes several, by its name in their folder. Plain value.
#pragma once

#include <string>
#include <vector>

namespace hermite {

struct NamedFile {
  std::string name;  // letters, digits, '.', '_' and '-': other programs split at blanks
  std::string bytes;
};
using NamedFiles = std::vector<NamedFile>;

}  // namespace hermite
