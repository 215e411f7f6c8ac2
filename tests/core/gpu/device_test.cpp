#include "core/gpu/device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>

#include "core/gpu/buffer.h"
#include "core/gpu/commands.h"
#include "core/gpu/descriptor_sets.h"

namespace hermite::gpu::device_test {
namespace {

// Sets a variable for one test.
class Environment {
 public:
  explicit Environment(const char* value, const char* name = "HERMITE_VALIDATION") : name_(name) {
    if (const char* was = std::getenv(name)) before_ = was;
    setenv(name, value, 1);
  }
  ~Environment() { before_.empty() ? unsetenv(name_) : setenv(name_, before_.c_str(), 1); }

 private:
  const char* name_;
  std::string before_;
};

TEST(Device, ListSaysWhatAPersonAsksFor) {
  const std::vector<DeviceInfo> devices = list_devices();
  ASSERT_FALSE(devices.empty()) << "these tests need a Vulkan device; Mesa's software one will do";
  for (std::size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(devices[i].index, static_cast<int>(i));
    EXPECT_FALSE(devices[i].name.empty());
    EXPECT_FALSE(devices[i].driver.empty());
    EXPECT_GT(devices[i].memory_bytes, 0u);
    EXPECT_GE(devices[i].all_memory_bytes, devices[i].memory_bytes);
    EXPECT_GE(devices[i].max_buffer_bytes, 128u << 20) << "the least that Vulkan promises";
    EXPECT_GE(devices[i].max_shared_memory_bytes, 16384u);
  }
}

TEST(Device, OpensTheOneSelectedAndAgreesWithTheList) {
  const std::vector<DeviceInfo> devices = list_devices();
  for (const DeviceInfo& info : devices) {
    if (!info.unsuitable.empty()) continue;
    const Device device(std::to_string(info.index));
    EXPECT_EQ(device.info().name, info.name);
    EXPECT_EQ(device.info().max_buffer_bytes, info.max_buffer_bytes);
  }
}

TEST(Device, RefusesWhatIsNotThere) {
  try {
    const Device device("no such GPU");
    FAIL();
  } catch (const SetupError& error) {
    EXPECT_EQ(error.error().code, ErrorCode::kDevice);
    EXPECT_THAT(error.what(), testing::HasSubstr("no such GPU"));
    EXPECT_THAT(error.what(), testing::HasSubstr(list_devices().at(0).name));
  }
}

TEST(Device, SeveralLiveSideBySide) {
  Device first, second;
  Buffer<int> a(first, 4, "a"), b(second, 4, "b");
  a.upload(std::vector<int>{1, 2, 3, 4});
  b.upload(std::vector<int>{5, 6, 7, 8});
  EXPECT_EQ(a.download(), (std::vector<int>{1, 2, 3, 4}));
  EXPECT_EQ(b.download(), (std::vector<int>{5, 6, 7, 8}));
  EXPECT_FALSE(second.memory_by_purpose().contains("a"));
}

TEST(Device, GoesWithoutWhatTheEnvironmentSays) {
  const Environment without("push-descriptors,texel-buffers,64-bit-atomics", "HERMITE_GPU_WITHOUT");
  Device device;
  EXPECT_EQ(substituted_as_text(device.info()),
            "push descriptors, large texel buffers, 64-bit atomics");
  Buffer<std::uint32_t> counts(device, 64, "counts"), words(device, 3, "words"),
      target(device, 16, "target");
  Buffer<std::array<std::uint32_t, 2>> pairs(device, 1, "pairs");
  Buffer<std::array<std::uint32_t, 12>> transforms(device, 1, "transforms");
  EXPECT_EQ(BufferRef(counts).texels, VK_NULL_HANDLE);
  words.upload(std::vector<std::uint32_t>{1, 2, 3});
  pairs.upload(std::vector<std::array<std::uint32_t, 2>>{{4, 5}});
  transforms.upload(
      std::vector<std::array<std::uint32_t, 12>>{{6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17}});
  const Kernel count(device, "test/count"), texels(device, "test/texels");
  Commands commands(device);
  for (int round = 0; round < 3; ++round) {
    // More sets than a pool has.
    for (int i = 0; i < 200; ++i) commands.dispatch(count, {64}, {{"counts", counts}});
    commands.dispatch(texels, {1},
                      {{"halves", words},
                       {"words", words},
                       {"pairs", pairs},
                       {"transforms", transforms},
                       {"target", target}});
    commands.submit_and_wait();
  }
  EXPECT_EQ(counts.download(), std::vector<std::uint32_t>(64, 600));
  EXPECT_EQ(target.download(),
            (std::vector<std::uint32_t>{1, 1, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17}));
  EXPECT_THROW(Kernel(device, "map/index_nearest"), DeviceError) << "it needs 64-bit atomics";
  EXPECT_EQ(device.validation_error_count(), 0);
}

TEST(Device, RefusesToGoWithoutWhatNobodyKnows) {
  const Environment without("push-descriptors,gravity", "HERMITE_GPU_WITHOUT");
  EXPECT_THROW(list_devices(), SetupError);
}

TEST(Device, PoolsGrowToTheLongestListOnly) {
  const Environment without("push-descriptors", "HERMITE_GPU_WITHOUT");
  Device device;
  const Kernel kernel(device, "test/count");
  DescriptorSets sets(device);
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < 100; ++i) EXPECT_NE(sets.next(kernel.set_layout()), VK_NULL_HANDLE);
    sets.take_back();
    EXPECT_EQ(sets.pool_count(), 2u);
  }
}

TEST(Device, ValidationFollowsTheEnvironment) {
  {
    const Environment off("0");
    EXPECT_FALSE(Device().validation_active());
  }
  const Environment on("1");
  const Device device;
  if (!device.validation_active()) GTEST_SKIP() << "VK_LAYER_KHRONOS_validation is not installed";
  EXPECT_EQ(device.validation_error_count(), 0);
}

TEST(Device, ValidationErrorsAreCountedAndPrinted) {
  const Environment on("1");
  Device device;
  if (!device.validation_active()) GTEST_SKIP() << "VK_LAYER_KHRONOS_validation is not installed";
  VkBufferCreateInfo nonsense{};
  nonsense.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  nonsense.size = 0;  // buffers have at least one byte
  nonsense.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  testing::internal::CaptureStderr();
  if (vkCreateBuffer(device.vk(), &nonsense, nullptr, &buffer) == VK_SUCCESS)
    vkDestroyBuffer(device.vk(), buffer, nullptr);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("VUID-VkBufferCreateInfo-size"));
  EXPECT_GT(device.validation_error_count(), 0);
}

}  // namespace
}  // namespace hermite::gpu::device_test
