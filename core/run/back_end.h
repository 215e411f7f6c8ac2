// What a pipeline takes from others, as the server and `hermite reconstruct` give it.
#pragma once

#include "core/pipeline/pipeline.h"

namespace hermite {

// Mapping as the options have it, and a watch over the camera. Past frames are for the caller to add.
BackEnd make_back_end(const Options& options, CorrectionTime time);

}  // namespace hermite
