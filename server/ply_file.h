// Reads a PLY file named on the command line.
#pragma once

#include <cstddef>
#include <string>

#include "core/output/ply_reader.h"

namespace hermite::commands {

// Some 90 million points as written by this program.
inline constexpr std::size_t kMaxPly_bytes = std::size_t{4} << 30;

// Throws SetupError, with a message that names the path: missing, too large, or not a PLY file.
output::PlyShape read_ply_file(const std::string& path);

}  // namespace hermite::commands
