#include "core/gpu/device_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>

#include "core/gpu/commands.h"
#include "core/gpu/embedded.h"

namespace hermite::gpu {

namespace {

constexpr std::size_t kCopyBytes = std::size_t{32} << 20;
// A small room at 5 mm with its frame maps.
constexpr std::uint64_t kLeastMemoryBytes = std::uint64_t{1} << 30;

template <class Work>
double seconds(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Measures the second run, because the first includes page faults and staging.
template <class Work>
double warm_gib_per_s(std::size_t bytes, Work&& work) {
  work();
  return static_cast<double>(bytes) / (1024.0 * 1024.0 * 1024.0) / std::max(seconds(work), 1e-9);
}

void compile_all(Device& device, DeviceCheck& check) {
  for (const EmbeddedKernel& shader : embedded_kernels()) {
    if (shader.interface.needs_64_bit_atomics && !device.info().has_64_bit_atomics) continue;
    DeviceCheck::Compiled compiled{std::string(shader.name), 0, ""};
    try {
      compiled.compile_ms = 1000 * seconds([&] { const Kernel made(device, shader.name); });
    } catch (const DeviceError& error) {
      compiled.error = error.what();
      check.problems.push_back(error.what());
    }
    check.kernels.push_back(std::move(compiled));
  }
}

void measure_copies(Device& device, DeviceCheck& check) {
  const std::size_t count = std::min<std::uint64_t>(kCopyBytes, device.info().max_buffer_bytes) / 4;
  std::vector<std::uint32_t> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<std::uint32_t>(i * 2654435761u);
  Buffer<std::uint32_t> first(device, count, "check"), second(device, count, "check");
  std::vector<std::uint32_t> back(count);
  Commands commands(device);
  const std::size_t bytes = count * 4;
  check.host_sees_device_memory = first.is_mapped();
  check.upload_gib_per_s = warm_gib_per_s(bytes, [&] { first.upload(values); });
  check.device_copy_gib_per_s = warm_gib_per_s(bytes, [&] {
    commands.copy(first, second, bytes);
    commands.submit_and_wait();
  });
  check.download_gib_per_s = warm_gib_per_s(bytes, [&] { second.download_into(back); });
  if (back != values) check.problems.push_back("data changed on the way to the GPU and back");
}

void measure_submission(Device& device, DeviceCheck& check) {
  constexpr int kRounds = 50;
  const Buffer<std::uint32_t> word(device, 1, "check");
  Commands commands(device);
  const auto submit = [&] {
    commands.fill(word, 1);
    commands.submit_and_wait();
  };
  submit();
  check.submission_us = 1e6 / kRounds * seconds([&] {
                          for (int i = 0; i < kRounds; ++i) submit();
                        });
}

}  // namespace

DeviceCheck check_device(const std::string& select) {
  Device device(select);
  DeviceCheck check;
  check.info = device.info();
  check.has_timestamps = device.timestamp_period_ns() > 0;
  for (std::uint32_t i = 0; i < device.memory().memoryHeapCount; ++i) {
    const VkMemoryHeap& heap = device.memory().memoryHeaps[i];
    check.heaps.push_back({heap.size, (heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0});
  }
  if (check.info.memory_bytes < kLeastMemoryBytes)
    check.problems.push_back(fmt::format("only {} of GPU memory, a scan wants at least {}",
                                         bytes_as_text(check.info.memory_bytes),
                                         bytes_as_text(kLeastMemoryBytes)));
  compile_all(device, check);
  try {
    measure_copies(device, check);
    measure_submission(device, check);
  } catch (const DeviceError& error) {
    check.problems.push_back(error.what());
  }
  if (device.validation_error_count() > 0)
    check.problems.push_back(std::to_string(device.validation_error_count()) +
                             " errors of the Vulkan validation layer");
  return check;
}

}  // namespace hermite::gpu
