#include "core/gpu/device_info.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "core/base/result.h"

namespace hermite::gpu {

namespace {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_index(const std::string& text) {
  return !text.empty() && text.size() <= 4 &&
         std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool matches(const DeviceInfo& info, const std::string& select) {
  if (select.empty()) return true;
  if (is_index(select)) return info.index == std::stoi(select);
  return lower_case(info.name).find(lower_case(select)) != std::string::npos;
}

[[noreturn]] void refuse(const std::vector<DeviceInfo>& devices, const std::string& reason) {
  std::string text = reason + "; present:";
  if (devices.empty()) text += " no Vulkan device at all";
  for (const DeviceInfo& info : devices) text += "\n  " + as_text(info);
  throw SetupError(Error{ErrorCode::kDevice, text});
}

}  // namespace

const char* name_of(DeviceKind kind) {
  switch (kind) {
    case DeviceKind::kDiscrete: return "discrete";
    case DeviceKind::kIntegrated: return "integrated";
    case DeviceKind::kVirtual: return "virtual";
    case DeviceKind::kCpu: return "cpu";
    case DeviceKind::kOther: return "other";
  }
  return "other";
}

std::string as_text(const DeviceInfo& info) {
  std::string text =
      fmt::format("{}: {} ({}, {})", info.index, info.name, name_of(info.kind), info.driver);
  if (!info.unsuitable.empty()) text += " cannot be used: " + info.unsuitable;
  return text;
}

std::string substituted_as_text(const DeviceInfo& info) {
  std::string text;
  const auto add = [&text](bool has, const char* what) {
    if (!has) text += (text.empty() ? "" : ", ") + std::string(what);
  };
  add(info.has_push_descriptors, "push descriptors");
  add(info.has_texel_buffers, "large texel buffers");
  add(info.has_64_bit_atomics, "64-bit atomics");
  return text;
}

std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& select) {
  std::optional<std::size_t> best;
  bool any_match = false;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (!matches(devices[i], select)) continue;
    any_match = true;
    if (!devices[i].unsuitable.empty()) continue;
    // The enumerators are in order of preference.
    if (!best || devices[i].kind < devices[*best].kind) best = i;
  }
  if (best) return *best;
  if (select.empty()) refuse(devices, "no usable GPU");
  refuse(devices, any_match ? fmt::format("the GPU selected by '{}' cannot be used", select)
                            : fmt::format("no GPU matches '{}'", select));
}

}  // namespace hermite::gpu
