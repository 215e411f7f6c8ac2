// The back-end parts that a pipeline gets from its caller, the same in the server and in `hermite
// reconstruct`.
#pragma once

#include "core/pipeline/pipeline.h"

namespace hermite::run {

// Returns the mapping that the options configure and the calibration watch. The caller adds access
// to past frames.
pipeline::BackEnd make_back_end(const pipeline::Options& options, adjust::CorrectionTime time);

}  // namespace hermite::run
