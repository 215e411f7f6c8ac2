#include "core/gpu/unused_gpu.h"

#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

namespace hermite::gpu {

namespace {

// Returns the first device file of a GPU's driver in the kernel: of NVIDIA's, or of another one;
// empty: there is none.
std::string device_file(const std::string& folder, bool& is_nvidia) {
  std::error_code error;
  const std::string nvidia = folder + "/nvidiactl";
  is_nvidia = std::filesystem::exists(nvidia, error);
  if (is_nvidia) return nvidia;
  std::string first;
  for (const auto& entry : std::filesystem::directory_iterator(folder + "/dri", error)) {
    const std::string path = entry.path().string();
    if (entry.path().filename().string().starts_with("renderD") && (first.empty() || path < first))
      first = path;
  }
  return first;
}

}  // namespace

std::string unused_gpu_message(const DeviceInfo& used, const std::string& device_files) {
  if (used.kind != DeviceKind::kCpu) return "";
  bool is_nvidia = false;
  const std::string file = device_file(device_files, is_nvidia);
  if (file.empty()) return "";
  const std::string message =
      fmt::format("the machine has a GPU ({}), but scans run on the processor: ", file);
  if (access(file.c_str(), R_OK | W_OK) != 0)
    return message + "this user may not open it; on Debian the groups render and video may";
  // Named by the maintainers of NVIDIA's container toolkit,
  // https://github.com/NVIDIA/nvidia-container-toolkit/issues/1021.
  if (is_nvidia)
    return message +
           "NVIDIA's Vulkan driver also needs the packages libegl1 and libxext6, and in a "
           "container the capability graphics";
  return message +
         "its Vulkan driver is missing; on Debian those of AMD and Intel are in "
         "mesa-vulkan-drivers";
}

}  // namespace hermite::gpu
