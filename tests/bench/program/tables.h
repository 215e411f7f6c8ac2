// A measurement in Markdown, for people and for tests/bench/README.md.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/program/measure.h"
#include "tests/bench/program/pass_costs.h"
#include "tests/bench/program/roofline.h"

namespace hermite::bench {

// One number for each frame, by what it is of; in the order in which they first appear.
struct Series {
  std::string name;
  std::vector<double> values;
};
std::vector<Series> stage_times_ms(const Measurement& measurement);

// Of one GPU pass.
struct PassSeries {
  std::string name;
  std::vector<double> dispatches;           // of each frame
  std::vector<double> gpu_ms;               // summed over its dispatches
  std::vector<double> bound_ms;             // 0 where it is not known
  double memory_ms = 0, arithmetic_ms = 0;  // bounds by either, of all frames together
};
std::vector<PassSeries> pass_times(const Measurement& measurement,
                                   const std::vector<PassCost>& costs, const Roofline& roofline);

// Times of frames and stages; of passes, the dearest first; memory; surfels.
std::string format_tables(const Measurement& measurement, const std::vector<PassCost>& costs,
                          const Roofline& roofline);

}  // namespace hermite::bench
