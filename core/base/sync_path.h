// Makes data at a path durable. A new file or folder, a rename and a removal only survive a power
// cut once the folder that contains the name has been synced too.
#pragma once

#include <string>

#include "core/base/result.h"

namespace hermite {

// Syncs the contents of a file, or the names in a folder. Blocks on the disk. Returns kIo with the
// path and the system's message. Thread-safe.
Status sync_path(const std::string& path);

}  // namespace hermite
