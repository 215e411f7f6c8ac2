// A PLY file that somebody has named on the command line.
#pragma once

#include <cstddef>
#include <string>

#include "core/output/ply_reader.h"

namespace hermite {

inline constexpr std::size_t kMaxPly_bytes = std::size_t{4} << 30;  // some 90 million of our points

// Throws SetupError in words that name the path: not there, too large, or no PLY.
PlyShape read_ply_file(const std::string& path);

}  // namespace hermite
