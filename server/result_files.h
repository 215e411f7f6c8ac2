// Reads the folder of a result, as written by hermite reconstruct, to measure in it.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/ply_points.h"

namespace hermite::commands {

struct ResultFiles {
  std::string trajectory_text, report_json;
  output::ReadPart surfels;  // reads surfels.ply, which stays open
};

// kNotFound, kIo, kTooLarge (kMaxTextFile_bytes), naming the file.
Result<ResultFiles> read_result_files(const std::string& folder);

}  // namespace hermite::commands
