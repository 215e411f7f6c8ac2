// The root of the source tree, for tests that read files of it. Told by CMake: __FILE__ is relative
// where ccache serves several clones.
#pragma once

#include <filesystem>

namespace hermite::test {

std::filesystem::path source_root();

}  // namespace hermite::test
