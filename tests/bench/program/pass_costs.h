// The least that a GPU pass must move and compute, counted by hand from the shaders: with the
// device's roofline, the time below which it cannot be. Rough (tens of per cent), but the same for
// every device, and enough to see which pass is far from what is possible.
#pragma once

#include <string>
#include <vector>

#include "core/base/timeline.h"
#include "core/pipeline/options.h"
#include "tests/bench/program/roofline.h"

namespace hermite::bench {

// Bytes: what the pass reads and writes of its own, once; what neighbours read again is in the
// cache. Flops: additions, multiplications, divisions, roots and exponentials, one each; neither
// integers nor comparisons. Where the data decide, the common case: every pixel has a surface,
// every surfel is alive.
struct PassCost {
  std::string pass;
  double bytes_per_invocation = 0;
  double flops_per_invocation = 0;
  // Bytes for each byte within reach: for passes that read and write all of every buffer they bind,
  // whatever their number of invocations.
  double bytes_per_byte = 0;
  double flops_per_byte = 0;
};

// Every pass of the reconstruction that takes time and whose invocations the host decides. Some
// depend on options.
std::vector<PassCost> pass_costs(const pipeline::Options& options);

struct PassBound {
  double memory_ms = 0, arithmetic_ms = 0;  // the longer one bounds it
};

// Zero for passes that are not counted.
PassBound bound_of(const Timeline::Pass& pass, const std::vector<PassCost>& costs,
                   const Roofline& roofline);

}  // namespace hermite::bench
