#include "tests/source_root/source_root.h"

namespace hermite::test {

std::filesystem::path source_root() { return HERMITE_SOURCE_ROOT; }

}  // namespace hermite::test
