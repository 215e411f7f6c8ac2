// How a scan ends without results. Stateless functions.
#pragma once

#include <optional>
#include <string>

#include "core/base/result.h"
#include "server/scan/scan_worker.h"
#include "server/store/blobs.h"

namespace hermite::server {

ScanEnd failed_scan(const Error& error);

// The results could not be stored, because of `why`; `reason`: why the scan ended early, if it did.
// The results can be made again from the frames; the part that was stored is removed.
ScanEnd not_stored(Blobs& blobs, const std::string& scan_id, const std::optional<Error>& reason,
                   const Error& why);

}  // namespace hermite::server
