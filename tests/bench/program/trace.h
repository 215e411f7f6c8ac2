// A measurement as a trace that chrome://tracing and ui.perfetto.dev draw: the "JSON Array Format"
// of Google's trace event format.
#pragma once

#include <ostream>

#include "tests/bench/program/measure.h"

namespace hermite::bench {

// One complete event ("ph": "X") for each frame, stage and GPU pass, in microseconds since the
// first frame. Frames and the stages within them on one track, GPU passes on another.
void write_trace(std::ostream& out, const Measurement& measurement);

}  // namespace hermite::bench
