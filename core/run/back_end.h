// The parts that a pipeline is given by its caller, the same in the server and in `hermite reconstruct`.
#pragma once

#include "core/pipeline/pipeline.h"

namespace hermite {

// Mapping as configured by the options, and the camera calibration watch. The caller adds access to past frames.
BackEnd make_back_end(const Options& options, CorrectionTime time);

}  // namespace hermite
