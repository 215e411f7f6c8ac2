#include "tests/bench/program/trace.h"

#include "core/base/chrome_trace.h"

namespace hermite::bench {

namespace {

constexpr int kHostTrack = 1, kGpuTrack = 2;

}  // namespace

void write_trace(std::ostream& out, const Measurement& measurement) {
  ChromeTrace trace(out, measurement.frames.empty() ? Timeline::Clock::time_point{}
                                                    : measurement.frames.front().start);
  trace.name_process("hermite on " + measurement.statistics.device);
  trace.name_track(kHostTrack, "frames and stages");
  trace.name_track(kGpuTrack, "GPU passes");
  for (const MeasuredFrame& frame : measurement.frames) {
    trace.add({"frame " + std::to_string(frame.index), "frame", kHostTrack, frame.start,
               frame.wall_ms, frame.tracked ? R"({"tracked":true})" : R"({"tracked":false})"});
    for (const Timeline::Stage& stage : frame.timeline.stages)
      trace.add({stage.name, "stage", kHostTrack, stage.start, stage.duration_ms});
    for (const Timeline::Pass& pass : frame.timeline.passes)
      trace.add({pass.name, "pass", kGpuTrack, pass.start, pass.duration_ms,
                 R"({"invocations":)" + std::to_string(pass.invocations) + '}'});
  }
  trace.finish();
}

}  // namespace hermite::bench
