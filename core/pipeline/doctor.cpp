#include "core/pipeline/doctor.h"

#include <fmt/core.h>

#include "core/base/result.h"
#include "core/gpu/device.h"
#include "core/gpu/device_check.h"
#include "core/gpu/unused_gpu.h"

namespace hermite::pipeline {

namespace {

void describe(const gpu::DeviceCheck& check, DeviceReport& report) {
  report.facts.push_back("using " + gpu::as_text(check.info));
  if (const std::string message = gpu::substituted_as_text(check.info); !message.empty())
    report.facts.push_back("done without, at some cost: " + message);
  for (const gpu::DeviceCheck::Heap& heap : check.heaps)
    report.facts.push_back(fmt::format("memory heap: {}{}", gpu::bytes_as_text(heap.bytes),
                                       heap.device_local ? ", on the device" : ", of the host"));
  report.facts.push_back(fmt::format("largest buffer: {}; shared memory: {}",
                                     gpu::bytes_as_text(check.info.max_buffer_bytes),
                                     gpu::bytes_as_text(check.info.max_shared_memory_bytes)));
  report.facts.push_back(
      fmt::format("copies: upload {:.1f}, download {:.1f}, on the device {:.1f} GiB/s; one "
                  "submission {:.1f} us",
                  check.upload_gib_per_s, check.download_gib_per_s, check.device_copy_gib_per_s,
                  check.submission_us));
  double compile_ms = 0;
  for (const gpu::DeviceCheck::Compiled& kernel : check.kernels) compile_ms += kernel.compile_ms;
  report.facts.push_back(
      fmt::format("{} shaders compiled in {:.1f} s", check.kernels.size(), compile_ms / 1000));
  report.facts.push_back(std::string("timestamps: ") +
                         (check.has_timestamps ? "yes" : "no: times per pass will be missing"));
  report.problems.insert(report.problems.end(), check.problems.begin(), check.problems.end());
}

// A user who selects a processor by name does not want a GPU.
std::string unused_gpu(const std::string& device, const gpu::DeviceInfo& used) {
  return device.empty() ? gpu::unused_gpu_message(used) : "";
}

}  // namespace

Result<OpenedDevice> open_device(const std::string& device) try {
  const gpu::DeviceInfo info = gpu::Device(device).info();
  return OpenedDevice{gpu::as_text(info), unused_gpu(device, info)};
} catch (const SetupError& error) {
  return error.error();
}

DeviceReport examine_device(const std::string& device) {
  DeviceReport report;
  try {
    for (const gpu::DeviceInfo& info : gpu::list_devices())
      report.facts.push_back("device " + gpu::as_text(info));
    const gpu::DeviceCheck check = gpu::check_device(device);
    describe(check, report);
    if (const std::string message = unused_gpu(device, check.info); !message.empty())
      report.facts.push_back("slow: " + message);
  } catch (const SetupError& error) {
    report.problems.push_back(error.what());
  }
  return report;
}

}  // namespace hermite::pipeline
