// The folder of a result, as hermite reconstruct writes it, for what is measured in it.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/ply_points.h"

namespace hermite {

struct ResultFiles {
  std::string trajectory_text, report_json;
  ReadPart surfels;  // of surfels.ply, which stays open
};

// kNotFound, kIo, kTooLarge (kMaxTextFile_bytes), naming the file.
Result<ResultFiles> read_result_files(const std::string& folder);

}  // namespace hermite
