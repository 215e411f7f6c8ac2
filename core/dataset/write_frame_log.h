// Writes a sequence as a frame log (core/log/frame_log.md), as if recorded by a camera: nothing is
// lost except the ground truth, which the format cannot contain.
#pragma once

#include "core/dataset/write_tum.h"

namespace hermite::dataset {

// Depth is RVL and zstd, colour the sequence's own bytes. `folder` must not exist. Frames that
// cannot be read are left out, with a remark for each of the first 20. kInvalidArgument; kIo;
// kCorruptData when no frame could be read.
Result<WriteSummary> write_frame_log(const Sequence& sequence, FrameRange range,
                                     const std::string& folder, const WriteProgress& progress);

}  // namespace hermite::dataset
