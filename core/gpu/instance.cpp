#include "core/gpu/instance.h"

#include <dlfcn.h>
#include <fmt/core.h>
#include <link.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>

#include "core/gpu/error.h"

namespace hermite::gpu {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
// Limits that the shaders rely on. Every desktop GPU of the last ten years exceeds them.
constexpr std::uint32_t kMinPushConstantBytes = 128;
constexpr std::uint32_t kMinSharedMemoryBytes = 32 * 1024;
constexpr std::uint32_t kMinInvocations = 256;
constexpr std::uint32_t kMinTexels = 1u << 22;  // pixels of the largest frames, surfels of a room

template <class T, class Enumerate>
std::vector<T> enumerate(Enumerate&& call) {
  std::vector<T> items;
  std::uint32_t count = 0;
  VkResult result = VK_INCOMPLETE;
  // The list may grow between the two calls.
  for (int attempt = 0; attempt < 4 && result == VK_INCOMPLETE; ++attempt) {
    if (call(&count, nullptr) != VK_SUCCESS) return {};
    items.resize(count);
    result = call(&count, items.data());
  }
  items.resize(result == VK_SUCCESS ? count : 0);
  return items;
}

// When the last instance is destroyed, the loader unloads the drivers, and memory that they
// allocate once per process is leaked each time (Mesa on AMD processors: the list of their caches).
// Loading LLVM again takes time, too. So loaded libraries stay loaded.
void keep_drivers_loaded() {
  std::vector<std::string> paths;
  dl_iterate_phdr(
      [](dl_phdr_info* module, std::size_t, void* found) {
        if (module->dlpi_name[0] != '\0')
          static_cast<std::vector<std::string>*>(found)->push_back(module->dlpi_name);
        return 0;
      },
      &paths);
  for (const std::string& path : paths)
    if (void* module = dlopen(path.c_str(), RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE))
      dlclose(module);
}

bool validation_wanted() {
  if (const char* wish = std::getenv("HERMITE_VALIDATION")) return std::strcmp(wish, "0") != 0;
  return HERMITE_VALIDATION != 0;
}

bool validation_installed() {
  const auto layers = enumerate<VkLayerProperties>(vkEnumerateInstanceLayerProperties);
  const auto extensions =
      enumerate<VkExtensionProperties>([](std::uint32_t* count, VkExtensionProperties* items) {
        return vkEnumerateInstanceExtensionProperties(kValidationLayer, count, items);
      });
  const auto is_layer = [](const VkLayerProperties& layer) {
    return std::strcmp(layer.layerName, kValidationLayer) == 0;
  };
  const auto is_messenger = [](const VkExtensionProperties& e) {
    return std::strcmp(e.extensionName, VK_EXT_DEBUG_UTILS_EXTENSION_NAME) == 0;
  };
  return std::any_of(layers.begin(), layers.end(), is_layer) &&
         std::any_of(extensions.begin(), extensions.end(), is_messenger);
}

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data,
                                          void* user) {
  if (severity < VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT) return VK_FALSE;
  auto* instance = static_cast<Instance*>(user);
  constexpr std::int64_t kMostPrinted = 20;  // an error in a loop must not fill the disk
  if (instance->validation_error_count() < kMostPrinted)
    std::fprintf(stderr, "Vulkan validation: %s\n", data->pMessage);
  instance->note_validation_error();
  return VK_FALSE;
}

DeviceKind kind_of(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return DeviceKind::kDiscrete;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return DeviceKind::kIntegrated;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return DeviceKind::kVirtual;
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return DeviceKind::kCpu;
    default: return DeviceKind::kOther;
  }
}

bool has_push_descriptors(VkPhysicalDevice device) {
  const auto extensions = enumerate<VkExtensionProperties>(
      [device](std::uint32_t* count, VkExtensionProperties* items) {
        return vkEnumerateDeviceExtensionProperties(device, nullptr, count, items);
      });
  return std::any_of(extensions.begin(), extensions.end(), [](const VkExtensionProperties& e) {
    return std::strcmp(e.extensionName, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME) == 0;
  });
}

// HERMITE_GPU_WITHOUT: see Device.
struct Without {
  bool push_descriptors = false, texel_buffers = false, atomics_64_bit = false;

  static Without from_environment() {
    Without without;
    const char* const list = std::getenv("HERMITE_GPU_WITHOUT");
    std::istringstream words(list ? list : "");
    for (std::string word; std::getline(words, word, ',');) {
      if (word == "push-descriptors")
        without.push_descriptors = true;
      else if (word == "texel-buffers")
        without.texel_buffers = true;
      else if (word == "64-bit-atomics")
        without.atomics_64_bit = true;
      else
        throw SetupError(
            Error{ErrorCode::kDevice, fmt::format("HERMITE_GPU_WITHOUT: '{}' is none of "
                                                  "push-descriptors, texel-buffers, 64-bit-atomics",
                                                  word)});
    }
    return without;
  }
};

struct Abilities {
  bool scalar_layout = false, atomics_64_bit = false;
};

Abilities abilities_of(VkPhysicalDevice device) {
  VkPhysicalDeviceVulkan12Features vulkan12{};
  vulkan12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  VkPhysicalDeviceFeatures2 features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  features.pNext = &vulkan12;
  vkGetPhysicalDeviceFeatures2(device, &features);
  return {vulkan12.scalarBlockLayout == VK_TRUE,
          features.features.shaderInt64 == VK_TRUE && vulkan12.shaderBufferInt64Atomics == VK_TRUE};
}

std::string why_unsuitable(VkPhysicalDevice device, const VkPhysicalDeviceProperties& properties) {
  const VkPhysicalDeviceLimits& limits = properties.limits;
  if (properties.apiVersion < VK_API_VERSION_1_2) return "Vulkan 1.2 is needed";
  if (find_compute_family(device) < 0) return "it has no compute queue";
  if (!abilities_of(device).scalar_layout) return "scalarBlockLayout is missing";
  if (limits.maxPushConstantsSize < kMinPushConstantBytes)
    return "fewer than 128 bytes of push constants";
  if (limits.maxComputeSharedMemorySize < kMinSharedMemoryBytes)
    return "less than 32 KiB of shared memory";
  if (limits.maxComputeWorkGroupInvocations < kMinInvocations ||
      limits.maxComputeWorkGroupSize[0] < kMinInvocations)
    return "work groups of fewer than 256 invocations";
  return {};
}

DeviceInfo describe(VkPhysicalDevice device, int index, const Without& without) {
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceMaintenance3Properties maintenance3{};
  maintenance3.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES;
  maintenance3.pNext = &driver;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = &maintenance3;
  vkGetPhysicalDeviceProperties2(device, &properties);
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(device, &memory);

  DeviceInfo info;
  info.index = index;
  info.name = properties.properties.deviceName;
  info.kind = kind_of(properties.properties.deviceType);
  info.driver = std::string(driver.driverName) +
                (driver.driverInfo[0] ? std::string(" ") + driver.driverInfo : std::string());
  info.api_version = properties.properties.apiVersion;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
    if (!(memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)) continue;
    info.memory_bytes = std::max<std::uint64_t>(info.memory_bytes, memory.memoryHeaps[i].size);
    info.all_memory_bytes += memory.memoryHeaps[i].size;
  }
  info.max_buffer_bytes = std::min<std::uint64_t>(
      properties.properties.limits.maxStorageBufferRange, maintenance3.maxMemoryAllocationSize);
  info.max_shared_memory_bytes = properties.properties.limits.maxComputeSharedMemorySize;
  info.has_push_descriptors = has_push_descriptors(device) && !without.push_descriptors;
  info.has_texel_buffers =
      properties.properties.limits.maxTexelBufferElements >= kMinTexels && !without.texel_buffers;
  info.has_64_bit_atomics = abilities_of(device).atomics_64_bit && !without.atomics_64_bit;
  info.unsuitable = why_unsuitable(device, properties.properties);
  return info;
}

}  // namespace

Instance::Instance() { create(validation_wanted() && validation_installed()); }

void Instance::create(bool with_validation) {
  VkDebugUtilsMessengerCreateInfoEXT messenger{};
  messenger.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
  messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType =
      VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT;
  messenger.pfnUserCallback = on_message;
  messenger.pUserData = this;

  VkApplicationInfo application{};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.pApplicationName = "hermite";
  application.apiVersion = VK_API_VERSION_1_2;
  const char* const messenger_extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  VkInstanceCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  create.pApplicationInfo = &application;
  if (with_validation) {
    create.pNext = &messenger;
    create.enabledLayerCount = 1;
    create.ppEnabledLayerNames = &kValidationLayer;
    create.enabledExtensionCount = 1;
    create.ppEnabledExtensionNames = &messenger_extension;
  }
  throw_if_failed(vkCreateInstance(&create, nullptr, &instance_), "start Vulkan");
  keep_drivers_loaded();
  if (!with_validation) return;
  const auto create_messenger = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
  if (create_messenger) create_messenger(instance_, &messenger, nullptr, &messenger_);
}

Instance::~Instance() {
  const auto destroy_messenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
  if (messenger_ != VK_NULL_HANDLE && destroy_messenger)
    destroy_messenger(instance_, messenger_, nullptr);
  vkDestroyInstance(instance_, nullptr);
}

std::vector<Instance::Candidate> Instance::candidates() const {
  const Without without = Without::from_environment();
  std::vector<Candidate> found;
  for (VkPhysicalDevice handle :
       enumerate<VkPhysicalDevice>([this](std::uint32_t*count, VkPhysicalDevice*items) {
         return vkEnumeratePhysicalDevices(instance_, count, items);
       }))
    found.push_back({handle, describe(handle, static_cast<int>(found.size()), without)});
  return found;
}

int find_compute_family(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  for (std::size_t i = 0; i < families.size(); ++i)
    if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) return static_cast<int>(i);
  return -1;
}

}  // namespace hermite::gpu
