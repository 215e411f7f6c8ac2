// The back-end parts that a pipeline gets from its caller, the same in the server and in `hermite
// reconstruct`.
#pragma once

#include "core/pipeline/pipeline.h"

namespace hermite {

// Returns the mapping that the options configure and the calibration watch. The caller adds access
// to past frames.
BackEnd make_back_end(const Options& options, CorrectionTime time);

}  // namespace hermite
