// Writes a sequence as a .klg (format in klg.cpp), for ElasticFusion and related programs. What the
// format cannot contain is written beside it, where our own reader looks: FILE.camera.json and, if
// there is a ground truth, FILE.groundtruth.txt.
#pragma once

#include "core/dataset/write_tum.h"

namespace hermite::dataset {

// Depth is zlib at its fastest level, colour the sequence's own JPEG, otherwise raw. The format has
// depth in millimetres and times in microseconds; other values are rounded, with a remark. `path`
// must not exist. kInvalidArgument; kIo; kCorruptData when no frame could be read.
Result<WriteSummary> write_klg(const Sequence& sequence, FrameRange range, const std::string& path,
                               const WriteProgress& progress);

}  // namespace hermite::dataset
