// The result of one frame of a run. A plain value.
#pragma once

#include "core/pipeline/pipeline.h"

namespace hermite::report {

struct FrameRow {
  pipeline::FrameResult result;
  double ms = 0;  // wall clock inside Pipeline::process()
};

}  // namespace hermite::report
