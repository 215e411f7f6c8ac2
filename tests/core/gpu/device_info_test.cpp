#include "core/gpu/device_info.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/result.h"

namespace hermite::gpu::device_info_test {
namespace {

DeviceInfo device(int index, const std::string& name, DeviceKind kind,
                  const std::string& unsuitable = "") {
  DeviceInfo info;
  info.index = index;
  info.name = name;
  info.kind = kind;
  info.driver = "Driver 1.0";
  info.unsuitable = unsuitable;
  return info;
}

const std::vector<DeviceInfo> kMachine = {
    device(0, "llvmpipe (LLVM 15)", DeviceKind::kCpu),
    device(1, "Old Radeon", DeviceKind::kDiscrete, "Vulkan 1.2 is needed"),
    device(2, "Intel UHD", DeviceKind::kIntegrated),
    device(3, "GeForce RTX 2070", DeviceKind::kDiscrete),
    device(4, "GeForce GTX 1080", DeviceKind::kDiscrete)};

std::string refusal(const std::vector<DeviceInfo>& devices, const std::string& select) {
  try {
    return "took " + std::to_string(choose_device(devices, select));
  } catch (const SetupError& error) {
    EXPECT_EQ(error.error().code, ErrorCode::kDevice);
    return error.what();
  }
}

TEST(ChooseDevice, TakesTheBestKindThatWorks) {
  EXPECT_EQ(choose_device(kMachine, ""), 3u);
  EXPECT_EQ(choose_device({kMachine[0], kMachine[1], kMachine[2]}, ""), 2u);
  EXPECT_EQ(choose_device({kMachine[0], kMachine[1]}, ""), 0u);
  EXPECT_EQ(choose_device({kMachine[0], device(1, "virtio", DeviceKind::kVirtual)}, ""), 1u);
}

TEST(ChooseDevice, ByIndex) { EXPECT_EQ(choose_device(kMachine, "2"), 2u); }

TEST(ChooseDevice, ByPartOfTheNameInAnyCase) {
  EXPECT_EQ(choose_device(kMachine, "LLVMPIPE"), 0u);
  EXPECT_EQ(choose_device(kMachine, "gtx"), 4u);
  EXPECT_EQ(choose_device(kMachine, "geforce"), 3u);  // the first of equals
}

TEST(ChooseDevice, RefusesWithAMessageAndListsWhatThereIs) {
  EXPECT_THAT(refusal(kMachine, "quadro"),
              testing::AllOf(testing::HasSubstr("no GPU matches 'quadro'"),
                             testing::HasSubstr("4: GeForce GTX 1080 (discrete, Driver 1.0)")));
  EXPECT_THAT(refusal(kMachine, "5"), testing::HasSubstr("no GPU matches '5'"));
  EXPECT_THAT(refusal(kMachine, "99999999999999999999"), testing::HasSubstr("no GPU matches"));
  EXPECT_THAT(refusal(kMachine, "-1"), testing::HasSubstr("no GPU matches"));
  EXPECT_THAT(refusal(kMachine, "1"), testing::AllOf(testing::HasSubstr("'1' cannot be used"),
                                                     testing::HasSubstr("Vulkan 1.2 is needed")));
  EXPECT_THAT(refusal({kMachine[1]}, ""), testing::AllOf(testing::HasSubstr("no usable GPU"),
                                                         testing::HasSubstr("Old Radeon")));
  EXPECT_THAT(refusal({}, ""), testing::HasSubstr("no Vulkan device at all"));
}

}  // namespace
}  // namespace hermite::gpu::device_info_test
