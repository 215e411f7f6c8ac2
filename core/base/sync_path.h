// Makes durable what is at a path. A new file or folder, a rename and a removal are safe from a power cut only when the folder that holds
// the name was synced, too.
#pragma once

#include <string>

#include "core/base/result.h"

namespace hermite {

// The contents of a file, or the names in a folder. Blocks on the disk. kIo, with the path and the system's words. Thread-safe.
Status sync_path(const std::string& path);

}  // namespace hermite
