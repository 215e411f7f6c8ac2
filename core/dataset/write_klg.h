// A sequence as a .klg (klg.cpp has the format), for ElasticFusion and its kin. What the format has no place for goes beside it, where our
// own reader looks: FILE.camera.json and, where there is a ground truth, FILE.groundtruth.txt.
#pragma once

#include "core/dataset/write_tum.h"

namespace hermite {

// Depth is zlib at its fastest, colour the sequence's own JPEG, else raw. The format has depth in millimetres and times in microseconds:
// what is neither is rounded, with a remark. `path` must not exist. kInvalidArgument; kIo; kCorruptData when no frame could be read.
Result<WriteSummary> write_klg(const Sequence& sequence, FrameRange range, const std::string& path, const WriteProgress& progress);

}  // namespace hermite
