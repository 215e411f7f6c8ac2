#include "tests/bench/program/roofline.h"

#include <algorithm>
#include <chrono>

#include "core/gpu/commands.h"

namespace hermite::bench {

namespace {

// Several times the largest cache of a GPU.
constexpr std::uint64_t kCopiedBytes = std::uint64_t{256} << 20;
constexpr std::uint32_t kBytesPerInvocation = 16;
// Within the work groups that every device has.
constexpr std::uint32_t kMostCopyInvocations = 1u << 22;
constexpr int kRepetitions = 5;

constexpr std::uint32_t kArithmeticInvocations = 1u << 18;
constexpr double kFlopsPerRound = 16 * 12 * 2;  // of shaders/bench/multiply_add.comp
constexpr double kLongEnough_ms = 20;
constexpr std::uint32_t kMostRounds = 1u << 20;

struct CopyParams {
  std::uint32_t count;
};
struct MultiplyAddParams {
  std::uint32_t rounds;
  float scale, offset;
};

// GPU time of what is recorded, or wall clock where the device has no time stamps.
double run_ms(gpu::Device& device, gpu::Commands& commands) {
  device.reset_pass_times();
  const auto start = std::chrono::steady_clock::now();
  commands.submit_and_wait();
  const double wall_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  double gpu_ms = 0;
  for (const gpu::Device::PassTime& pass : device.pass_times()) gpu_ms += pass.total_ms;
  return gpu_ms > 0 ? gpu_ms : wall_ms;
}

// The best of a few: whatever disturbs makes it slower.
double measure_memory_gb_per_s(gpu::Device& device) {
  const gpu::DeviceInfo& info = device.info();
  const std::uint64_t bytes =
      std::min({kCopiedBytes, info.max_buffer_bytes, info.memory_bytes / 8}) / kBytesPerInvocation *
      kBytesPerInvocation;
  gpu::Buffer<std::uint8_t> source(device, bytes, "bench"), target(device, bytes, "bench");
  const gpu::Kernel copy(device, "bench/copy");
  gpu::Commands commands(device);
  const CopyParams params{static_cast<std::uint32_t>(bytes / kBytesPerInvocation)};
  double best_ms = 1e300;
  for (int i = 0; i < kRepetitions; ++i) {
    commands.dispatch(copy, {std::min(params.count, kMostCopyInvocations)}, params,
                      {{"source", source}, {"target", target}});
    best_ms = std::min(best_ms, run_ms(device, commands));
  }
  return 2 * static_cast<double>(bytes) / best_ms * 1e-6;
}

double measure_gflop_per_s(gpu::Device& device) {
  const gpu::Buffer<float> result(device, kArithmeticInvocations, "bench");
  const gpu::Kernel multiply_add(device, "bench/multiply_add");
  gpu::Commands commands(device);
  const auto rounds_ms = [&](std::uint32_t rounds) {
    commands.dispatch(multiply_add, {kArithmeticInvocations},
                      MultiplyAddParams{rounds, 0.999f, 1e-3f}, {{"result", result}});
    return run_ms(device, commands);
  };
  std::uint32_t rounds = 4;
  while (rounds < kMostRounds && rounds_ms(rounds) < kLongEnough_ms) rounds *= 2;
  double best_ms = 1e300;
  for (int i = 0; i < kRepetitions; ++i) best_ms = std::min(best_ms, rounds_ms(rounds));
  return kFlopsPerRound * rounds * kArithmeticInvocations / best_ms * 1e-6;
}

}  // namespace

Roofline measure_roofline(const std::string& select) {
  gpu::Device device(select);
  Roofline roofline;
  roofline.device = device.info();
  roofline.has_timestamps = device.timestamp_period_ns() > 0;
  roofline.memory_gb_per_s = measure_memory_gb_per_s(device);
  roofline.gflop_per_s = measure_gflop_per_s(device);
  return roofline;
}

}  // namespace hermite::bench
