// Makes the files of a comparison from the results of two scans, on the thread that makes exports.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/named_file.h"
#include "server/exports/build_export.h"
#include "server/store/blobs.h"

namespace hermite::server {

// The largest file of surfels that is compared: some 2.6 million surfels.
inline constexpr std::uint64_t kMaxComparedCloud_bytes = std::uint64_t{128} << 20;
// The memory that comparing takes, as a multiple of the size of both files (core/compare/compare.h:
// 1 KB for each surfel).
inline constexpr double kCompareMemory = 20;

struct ComparedIds {
  std::string first, second;
};

// Returns the files of comparison_with(ids.second): the points only where both show the same place,
// then the report (core/compare/compare_output.h). kNotFound: a scan has no cloud;
// kInvalidArgument: its points have no normals, or are too few or too far apart; kTooLarge: more
// than kMaxComparedCloud_bytes, or than the free memory; kBusy: stopped; kCorruptData, kIo.
Result<output::NamedFiles> build_comparison(Blobs& blobs, const FreeMemory& free_memory,
                                            const ComparedIds& ids, const BuildProgress& progress);

}  // namespace hermite::server
