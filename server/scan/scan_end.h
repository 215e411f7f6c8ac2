// How a scan ends without results. Functions without state.
#pragma once

#include <optional>
#include <string>

#include "core/base/result.h"
#include "server/scan/scan_worker.h"
#include "server/store/blobs.h"

namespace hermite {

ScanEnd failed_scan(const Error& error);

// The disk did not take the results, for `why`; `reason`: why the scan ended early, if it did. The frames are there, so that they can be
// made again; what of them was stored is removed.
ScanEnd not_stored(Blobs& blobs, const std::string& scan_id, const std::optional<Error>& reason, const Error& why);

}  // namespace hermite
