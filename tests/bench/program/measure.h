// Runs the reconstruction over raw frames and keeps what each frame cost.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/timeline.h"
#include "core/pipeline/pipeline.h"
#include "core/raw/raw_frames.h"
#include "tests/bench/program/arguments.h"

namespace hermite::bench {

struct MeasuredFrame {
  std::int64_t index = 0;  // in the file
  bool tracked = false;    // weakly too
  Timeline::Clock::time_point start;
  double wall_ms = 0;  // inside Pipeline::process; reading the file is not in it
  Timeline timeline;
};

struct Measurement {
  std::vector<MeasuredFrame> frames;        // those after the warm-up
  pipeline::PipelineStatistics statistics;  // at the end, of all frames
};

// Frame of the file to be played as the `step`-th, so that the camera never jumps: 0 1 2 3 2 1 0 1
// ...
std::int64_t frame_to_play(std::int64_t step, std::int64_t file_frame_count);

// Surfels of rooms scanned before: small patches of surface all around, 25 to 55 m away, where no
// depth camera sees them.
output::Cloud elsewhere(std::int64_t count);

// How many to measure.
std::int64_t measured_frame_count(const Arguments& arguments, std::int64_t file_frame_count);

// Throws SetupError: no such device, a file that cannot be read, a device that is lost. Blocks for
// as long as the frames take.
Measurement measure(RawFrameReader& file, const Arguments& arguments);

// The value that `share` (0 to 1) of them do not exceed: the nearest rank, so one of the values. 0
// for none.
double percentile(std::vector<double> values, double share);

}  // namespace hermite::bench
