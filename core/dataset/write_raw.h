// Writes a sequence as our raw frames (core/raw/raw_frames.h).
#pragma once

#include "core/dataset/write_tum.h"

namespace hermite::dataset {

// Frames that cannot be read are black and without depth, with a remark, as in `hermite reconstruct
// --dump-raw`. `path` must not exist. kInvalidArgument, kIo.
Result<WriteSummary> write_raw(const Sequence& sequence, FrameRange range, const std::string& path,
                               const WriteProgress& progress);

}  // namespace hermite::dataset
