// Writes a sequence as a folder in the TUM layout: rgb/, depth/, rgb.txt, depth.txt,
// associations.txt, camera.json, and groundtruth.txt if there is one. Colour files are the
// sequence's own bytes, depth is a PNG of the sensor's values, and times are written so that they
// read back as the same numbers: what is read from the folder is identical bit for bit.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"

namespace hermite::dataset {

struct WriteSummary {
  std::int64_t frame_count = 0;  // written
  // Differences from the original: frames left out, values rounded.
  std::vector<std::string> remarks;
};

// Called after each frame with the number of frames done.
using WriteProgress = std::function<void(std::int64_t done)>;

// `folder` is created if necessary and must be empty. Frames that cannot be read are left out, with
// a remark for each of the first 20. kInvalidArgument, kIo; kCorruptData when no frame could be
// read.
Result<WriteSummary> write_tum(const Sequence& sequence, FrameRange range,
                               const std::string& folder, const WriteProgress& progress);

}  // namespace hermite::dataset
