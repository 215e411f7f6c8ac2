// How many entries a zip can have, from its end: libarchive reads the whole directory of a zip into
// memory before it gives the first.
#pragma once

#include <cstdint>

#include "core/base/result.h"

namespace hermite::archive {

// The greatest number of entries for which the file between the directory's begin and its end has
// room. kCorruptData when there is no directory. `descriptor` is of a regular file; its position
// stays.
Result<std::int64_t> max_zip_entries(int descriptor, std::int64_t file_bytes);

}  // namespace hermite::archive
