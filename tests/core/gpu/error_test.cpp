#include "core/gpu/error.h"

#include <gtest/gtest.h>

namespace hermite::gpu::error_test {
namespace {

TEST(DeviceError, SaysWhatWasTriedAndWhyItFailed) {
  try {
    throw_if_failed(VK_ERROR_OUT_OF_DEVICE_MEMORY, "allocate memory");
    FAIL();
  } catch (const SetupError& error) {
    EXPECT_EQ(error.error().code, ErrorCode::kDevice);
    EXPECT_STREQ(error.what(), "cannot allocate memory: out of GPU memory");
  }
  EXPECT_THROW(throw_if_failed(VK_ERROR_DEVICE_LOST, "run"), DeviceError);
}

TEST(DeviceError, SuccessAndMereStatusAreNoFailures) {
  EXPECT_NO_THROW(throw_if_failed(VK_SUCCESS, "run"));
  EXPECT_NO_THROW(throw_if_failed(VK_NOT_READY, "run"));
}

TEST(DeviceError, UnknownCodesKeepTheirNumber) {
  EXPECT_EQ(as_text(static_cast<VkResult>(-4711)), "Vulkan error -4711");
}

TEST(BytesAsText, PicksTheUnit) {
  EXPECT_EQ(bytes_as_text(0), "0 bytes");
  EXPECT_EQ(bytes_as_text((1 << 20) - 1), "1048575 bytes");
  EXPECT_EQ(bytes_as_text(3 << 19), "1.5 MiB");
  EXPECT_EQ(bytes_as_text(std::uint64_t{9} << 30), "9.0 GiB");
}

}  // namespace
}  // namespace hermite::gpu::error_test
