// Binary little-endian PLY: x y z nx ny nz (float) red green blue (uchar) confidence curvature_max
// curvature_min radius (float) submap (uint). Metres and 1/metres. Thread-safe.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite::output {

std::string format_ply(const Cloud& cloud);

// Writes a temporary file beside `path`, syncs and renames it: after a crash, the file is either
// complete or the previous one. Returns kIo with the system's message, and leaves no temporary
// file.
Status write_file_atomically(const std::string& path, const std::string& bytes);

}  // namespace hermite::output
