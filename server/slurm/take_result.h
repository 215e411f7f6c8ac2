// Takes the result of a run on a node into the data of this server: what the server would have
// written itself. Blocks on disks and the network. Any thread.
#pragma once

#include <string>

#include "core/base/result.h"
#include "server/store/blobs.h"
#include "server/store/data_directory.h"

namespace hermite::server {

// Stores the files of `result_folder` as blobs of the scan, and its frames as the scan's log; both
// are durable afterwards. The folder stays as it is, so that this can be done again: what exists of
// the scan is replaced. The caller adds the row. kIo; kTooLarge: a file that no scan has.
Status take_result(const std::string& result_folder, const std::string& scan_id,
                   const DataDirectory& data, Blobs& blobs);

}  // namespace hermite::server
