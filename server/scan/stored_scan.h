// Reads the results of an ended scan for its viewers. Blocks on storage.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/scan/subscribers.h"
#include "server/store/blobs.h"

namespace hermite::server {

// The contents of a Finished message. kNotFound, kIo.
Result<wire::Finished> read_results(Blobs& blobs, const std::string& scan_id);

// The counts of the map from the report; 0 without a report.
void read_map_counts(Blobs& blobs, const std::string& scan_id, wire::ScanState& state);

struct StoredScan {
  std::vector<float> positions_m;  // x y z, x y z, ... of the camera in the world
  std::optional<ModelUpdate> model;
  wire::ScanState map_counts;  // only the counts
};

// Reads whatever exists; a failed scan has no results, which is no error.
StoredScan read_stored_scan(Blobs& blobs, const std::string& scan_id);

}  // namespace hermite::server
