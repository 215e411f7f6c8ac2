// The files of a run: the same for a scan on the server and for `hermite reconstruct`, so that their hashes can be compared.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/dataset/trajectory.h"
#include "core/pipeline/options.h"
#include "core/pipeline/pipeline.h"

namespace hermite {

struct RunResults {
  std::string report_json;
  std::string trajectory_text;  // TUM
};

// Writes cloud.ply, trajectory.txt and, last, report.json into `folder`, which must exist; each is whole or absent.
// `groundtruth` may be empty. kIo or kDevice, naming the file. On the thread that owns `pipeline`.
Result<RunResults> write_results(const std::string& folder, Pipeline& pipeline, const Options& options, const Trajectory& groundtruth);

}  // namespace hermite
