// Handles files without a row in the store, which are left when a crash happens between creating a
// folder and its row, or when an older copy of the database or a new one is used. They may be all
// that is left of a scan, so they are kept for a while.
#pragma once

#include <chrono>
#include <cstdint>

#include "server/store/data_directory.h"
#include "server/store/store.h"

namespace hermite::server {

inline constexpr std::chrono::days kKeepLost(30);

// Moves folders of scans and files of uploads that have no row to lost/, moves what has been there
// for kKeepLost to waste/, and removes unfinished files that a crash has left among the results of
// scans. Logs all of it. Scans of jobs that have not ended count as known. Leaves everything that
// is not certainly unknown: names that are not ids, and everything on which the store fails.
//
// Call it at a start, before anything uses the files; the next Waste removes what has been moved to
// waste/.
void clear_orphans(const DataDirectory& data, Store& store, std::int64_t now_ms);

}  // namespace hermite::server
