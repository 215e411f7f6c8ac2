// Binary little-endian PLY: x y z nx ny nz red green blue confidence curvature_max curvature_min radius submap.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite {

std::string format_ply(const Cloud& cloud);

// Writes beside `path`, syncs, renames: the file is whole or absent.
Status write_file_atomically(const std::string& path, const std::string& bytes);

}  // namespace hermite
