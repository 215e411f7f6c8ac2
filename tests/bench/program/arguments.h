// The command line of hermite_bench, by hand: the machines it runs on have no library for it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/pipeline/options.h"

namespace hermite::bench {

struct Arguments {
  bool help = false;          // then nothing else counts
  std::string file;           // of raw frames
  std::string device;         // as for Pipeline
  std::string trace_file;     // empty: none
  pipeline::Options options;  // of the reconstruction
  std::int64_t warm_up_count = 10;
  std::int64_t elsewhere_count = 0;  // surfels of other places in the map from the start
  std::int64_t frame_count = 0;      // to measure; 0: all of the file, at least kFewestFrames
};

// For percentiles that mean something.
inline constexpr std::int64_t kFewestFrames = 200;

// Without the program's name. kInvalidArgument with a message; kNotFound for an unknown --set key.
Result<Arguments> parse_arguments(const std::vector<std::string>& words);

std::string help_text();

}  // namespace hermite::bench
