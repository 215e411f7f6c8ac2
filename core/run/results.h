// The results of a run, the same for a scan on the server and for `hermite reconstruct`, so that
// their hashes can be compared.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/base/result.h"
#include "core/dataset/trajectory.h"
#include "core/pipeline/options.h"
#include "core/pipeline/pipeline.h"

namespace hermite::run {

struct RunResults {
  std::string cloud_ply;
  std::string surfels_ply;      // Pipeline::surfels(), from which the mesh is made
  std::string trajectory_text;  // TUM
  std::string tracking_text;    // tracking_file.h
  std::string thumbnail_jpeg;   // core/thumbnail/thumbnail.h
  std::string report_json;
};

// Computes all results; `groundtruth` may be empty. Returns kDevice when the GPU fails. Call it on
// the thread that owns `pipeline`.
Result<RunResults> results_of(pipeline::Pipeline& pipeline, const pipeline::Options& options,
                              const dataset::Trajectory& groundtruth);

// The files in the order in which they are stored: the report is last, so that the results are
// complete once it exists.
struct ResultFile {
  // cloud.ply, surfels.ply, trajectory.txt, tracking.txt, thumbnail.jpg, report.json.
  const char* name;
  const std::string& bytes;
};
std::array<ResultFile, 6> files_of(const RunResults& results);

// Returns an upper estimate of the disk space [bytes] of these files and the chunks for a map of
// this size.
std::uint64_t room_for_results(std::uint64_t surfel_count, std::uint64_t frame_count);

}  // namespace hermite::run
