// The results of a scan that has ended, for those who look at it. Waits for where they are kept.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/scan/audience.h"
#include "server/store/blobs.h"

namespace hermite {

// What Finished says. kNotFound, kIo.
Result<wire::Finished> read_results(Blobs& blobs, const std::string& scan_id);

// What the report says about the map; 0 where there is none.
void read_map_counts(Blobs& blobs, const std::string& scan_id, wire::ScanState& state);

struct StoredScan {
  std::vector<float> positions_m;  // x y z, x y z, ... of the camera
  std::optional<ModelUpdate> model;
  wire::ScanState map_counts;  // nothing but those
};

// What is there: a scan that failed has no results, and that is no error of the viewer.
StoredScan read_stored_scan(Blobs& blobs, const std::string& scan_id);

}  // namespace hermite
