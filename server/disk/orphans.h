// Files that no row of the store knows: a death came between a folder and its row, an older copy of the database was put back, or a new one
// was begun. What they hold may be all that is left of a scan, so that a person gets time to miss it.
#pragma once

#include <chrono>
#include <cstdint>

#include "server/store/data_directory.h"
#include "server/store/store.h"

namespace hermite {

inline constexpr std::chrono::days kKeepLost(30);

// Moves folders of scans and files of uploads that nobody knows to lost/, and makes waste of what has been there for kKeepLost; removes the
// unfinished files that a death has left beside the results of scans. Logs all of it. A job that has not ended knows its scan, too. What is
// not surely unknown stays: names that are no ids, and everything the store cannot tell about.
//
// At a start, before anybody works with the files; what became waste is removed by the Waste that comes next.
void clear_orphans(const DataDirectory& data, Store& store, std::int64_t now_ms);

}  // namespace hermite
