#include "tests/bench/program/roofline.h"

#include <gtest/gtest.h>

#include "core/base/result.h"

namespace hermite::bench {
namespace {

TEST(Roofline, LiesWithinWhatMachinesDo) {
  const Roofline roofline = measure_roofline("");
  EXPECT_FALSE(roofline.device.name.empty());
  EXPECT_GT(roofline.memory_gb_per_s, 0.01);
  EXPECT_LT(roofline.memory_gb_per_s, 1e5);
  EXPECT_GT(roofline.gflop_per_s, 0.1);
  EXPECT_LT(roofline.gflop_per_s, 1e6);
}

TEST(Roofline, ADeviceThatIsNotThereIsSaid) {
  EXPECT_THROW(measure_roofline("no such device"), SetupError);
}

}  // namespace
}  // namespace hermite::bench
