// Makes the files of an imported scan from a cloud or mesh of another program. Pure.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/import/model.h"
#include "core/output/named_file.h"
#include "server/store/chunk_file.h"

namespace hermite::server {

// The most points and chunks that viewers are shown; beyond either a coarser level is used.
inline constexpr std::size_t kMostShownPoints = 3'000'000, kMostShownChunks = 20'000;

struct ImportResults {
  // Blobs of the scan: kImportedMeshFile for a mesh, cloud.ply for a cloud.
  output::NamedFiles files;
  std::vector<std::string> remarks;  // for the user
  bool may_be_meshed = false;        // a cloud with normals
};

// Makes the results from the bytes of a PLY or GLB file. Errors of core/import/model.h, and kBusy:
// `go_on` returned false; kUnsupported: Draco.
Result<ImportResults> results_of_import(std::string bytes, const imports::ImportOptions& options,
                                        const std::function<bool()>& go_on);

// The viewer's chunks, at the finest level within both limits.
Result<StoredChunks> chunks_of_points(const output::Cloud& cloud);

}  // namespace hermite::server
