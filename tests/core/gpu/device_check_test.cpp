#include "core/gpu/device_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/gpu/device.h"
#include "core/gpu/embedded.h"

namespace hermite::gpu::device_check_test {
namespace {

TEST(CheckDevice, CompilesEverythingAndMeasures) {
  const DeviceCheck check = check_device("");
  EXPECT_THAT(check.problems, testing::IsEmpty());
  EXPECT_FALSE(check.info.name.empty());
  EXPECT_THAT(check.heaps,
              testing::Contains(testing::Field(&DeviceCheck::Heap::device_local, true)));
  ASSERT_EQ(check.kernels.size() + (check.info.has_64_bit_atomics ? 0 : 1),
            embedded_kernels().size())
      << "one shader needs 64-bit atomics";
  for (const DeviceCheck::Compiled& compiled : check.kernels) {
    EXPECT_GT(compiled.compile_ms, 0) << compiled.kernel;
    EXPECT_EQ(compiled.error, "") << compiled.kernel;
  }
  for (double speed :
       {check.upload_gib_per_s, check.download_gib_per_s, check.device_copy_gib_per_s}) {
    EXPECT_GT(speed, 0.01);
    EXPECT_LT(speed, 20000);
  }
  EXPECT_GT(check.submission_us, 0);
  EXPECT_LT(check.submission_us, 20000);
}

TEST(CheckDevice, ADeviceThatIsNotThereIsASetupError) {
  EXPECT_THROW(check_device("no such GPU"), SetupError);
}

}  // namespace
}  // namespace hermite::gpu::device_check_test
