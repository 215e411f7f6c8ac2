// Several files as one .zip, in memory: without compression, because what is packed here is images
// or is unpacked at once. Pure.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace hermite::archive {

// Name ("images/0.jpg") and bytes.
using ZipEntries = std::vector<std::pair<std::string, std::string>>;

// Returns a zip without times and owners: the same files give the same bytes. kTooLarge: 4 GiB or
// more; kIo: with libarchive's message.
Result<std::string> format_zip(const ZipEntries& entries);

}  // namespace hermite::archive
