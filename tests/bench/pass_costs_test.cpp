#include "tests/bench/program/pass_costs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/gpu/embedded.h"

namespace hermite::bench {
namespace {

Roofline round_numbers() {
  Roofline roofline;
  roofline.memory_gb_per_s = 100;
  roofline.gflop_per_s = 1000;
  return roofline;
}

TEST(PassCosts, AreOfPassesThatExist) {
  for (const PassCost& cost : pass_costs({})) {
    if (cost.pass.starts_with("(")) continue;
    const auto kernels = gpu::embedded_kernels();
    EXPECT_TRUE(std::any_of(kernels.begin(), kernels.end(),
                            [&cost](const auto& kernel) { return kernel.name == cost.pass; }))
        << cost.pass << " was renamed or removed: count again";
    EXPECT_GT(cost.bytes_per_invocation + cost.bytes_per_byte, 0) << cost.pass;
  }
}

TEST(PassCosts, CountInvocationsAndBytes) {
  const std::vector<PassCost> costs{{"a", 50, 20, 0, 0}, {"b", 0, 0, 1, 40}};
  const PassBound a = bound_of({"a", {}, 1, 1'000'000, 77}, costs, round_numbers());
  EXPECT_DOUBLE_EQ(a.memory_ms, 0.5);
  EXPECT_DOUBLE_EQ(a.arithmetic_ms, 0.02);
  const PassBound b = bound_of({"b", {}, 1, 5, 10'000'000}, costs, round_numbers());
  EXPECT_DOUBLE_EQ(b.memory_ms, 0.1);
  EXPECT_DOUBLE_EQ(b.arithmetic_ms, 0.4);
}

TEST(PassCosts, WhatIsNotCountedHasNoBound) {
  const PassBound bound =
      bound_of({"elsewhere", {}, 1, 1'000'000, 1'000'000}, pass_costs({}), round_numbers());
  EXPECT_EQ(bound.memory_ms, 0);
  EXPECT_EQ(bound.arithmetic_ms, 0);
}

TEST(PassCosts, FollowTheOptions) {
  const auto predict_flops = [](const pipeline::Options& options) {
    for (const PassCost& cost : pass_costs(options))
      if (cost.pass == "map/predict") return cost.flops_per_invocation;
    return 0.0;
  };
  pipeline::Options options;
  const double usual = predict_flops(options);
  options.map.window = 9;
  EXPECT_GT(predict_flops(options), 2 * usual);
  options.map.hrbf_prediction = false;
  EXPECT_LT(predict_flops(options), usual);
}

}  // namespace
}  // namespace hermite::bench
