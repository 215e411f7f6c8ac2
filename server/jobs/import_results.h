// What a scan consists of that was not scanned but brought along: a cloud or a mesh of another program. Pure.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/import/model.h"
#include "core/output/named_file.h"
#include "server/store/chunk_file.h"

namespace hermite {

// Viewers are shown so many points of it: above that, and above that many chunks, a coarser level is taken.
inline constexpr std::size_t kMostShownPoints = 3'000'000, kMostShownChunks = 20'000;

struct ImportResults {
  NamedFiles files;                // blobs of the scan; a mesh is kImportedMeshFile, of a cloud there is cloud.ply, as of every scan
  std::vector<std::string> words;  // what a person should know
  bool may_be_meshed = false;      // it is a cloud with normals
};

// Of the bytes of a PLY or GLB file (core/import/model.h). Its errors; kBusy: `go_on` said no; kUnsupported: Draco's words.
Result<ImportResults> results_of_import(std::string bytes, const ImportOptions& options, const std::function<bool()>& go_on);

// The chunks that viewers are shown, at the finest level that stays within both limits.
Result<StoredChunks> chunks_of_points(const Cloud& cloud);

}  // namespace hermite
