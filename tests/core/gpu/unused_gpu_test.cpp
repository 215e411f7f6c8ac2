#include "core/gpu/unused_gpu.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace hermite::gpu::unused_gpu_test {
namespace {

using testing::HasSubstr;

class UnusedGpu : public testing::Test {
 protected:
  void put(const std::string& name) {
    const std::filesystem::path path = std::filesystem::path(folder_.path()) / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << "";
  }
  std::string message_of(DeviceKind kind) const {
    DeviceInfo used;
    used.kind = kind;
    return unused_gpu_message(used, folder_.path());
  }

  const test::TemporaryFolder folder_;
};

TEST_F(UnusedGpu, IsNoneOnAMachineWithoutAGpuAndWhereOneIsUsed) {
  EXPECT_EQ(message_of(DeviceKind::kCpu), "");
  put("nvidiactl");
  put("dri/renderD128");
  EXPECT_EQ(message_of(DeviceKind::kDiscrete), "");
  EXPECT_EQ(message_of(DeviceKind::kIntegrated), "");
}

TEST_F(UnusedGpu, OfNvidiaNeedsPackages) {
  put("nvidiactl");
  EXPECT_THAT(message_of(DeviceKind::kCpu), HasSubstr("libegl1 and libxext6"));
}

TEST_F(UnusedGpu, OfMesaNeedsItsDrivers) {
  put("dri/card0");
  EXPECT_EQ(message_of(DeviceKind::kCpu), "") << "a screen alone is no GPU";
  put("dri/renderD129");
  put("dri/renderD128");
  EXPECT_THAT(message_of(DeviceKind::kCpu), HasSubstr("renderD128"));
  EXPECT_THAT(message_of(DeviceKind::kCpu), HasSubstr("mesa-vulkan-drivers"));
}

}  // namespace
}  // namespace hermite::gpu::unused_gpu_test
