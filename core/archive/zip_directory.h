// How many entries a zip can have, from its end: libarchive reads the whole directory of a zip into
// memory before it gives the first.
#pragma once

#include <cstdint>

#include "core/base/result.h"

namespace hermite::archive {

// Returns the largest number of entries that fit between the beginning and the end of the
// directory. kCorruptData when there is no directory. `descriptor` is of a regular file; its
// position does not change.
Result<std::int64_t> max_zip_entries(int descriptor, std::int64_t file_bytes);

}  // namespace hermite::archive
