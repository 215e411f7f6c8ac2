// The edits of a scan (core/edit), as a blob beside its results.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/edit/scan_edits.h"
#include "server/store/blobs.h"

namespace hermite::server {

inline constexpr const char* kEditsFile = "edits.json";
// More than kMostEdits boxes whose numbers have all their digits.
inline constexpr std::size_t kMaxEdits_bytes = 16 * 1024;

// Returns version 0 and no edits if the scan was never edited. kIo; kCorruptData, which begins with
// the name of the file. Blocking; any thread.
Result<edit::ScanEdits> read_edits(Blobs& blobs, const std::string& scan_id);

}  // namespace hermite::server
