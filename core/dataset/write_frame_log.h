// A sequence as a frame log (core/log/frame_log.md), as if a camera had recorded it: nothing is lost but the ground truth, which the format
// has no place for.
#pragma once

#include "core/dataset/write_tum.h"

namespace hermite {

// Depth is RVL and zstd, colour the sequence's own bytes. `folder` must not exist. Frames that cannot be read are left out, with a remark
// each (the first 20 of them). kInvalidArgument; kIo; kCorruptData when no frame could be read.
Result<WriteSummary> write_frame_log(const Sequence& sequence, FrameRange range, const std::string& folder, const WriteProgress& progress);

}  // namespace hermite
