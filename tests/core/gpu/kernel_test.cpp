#include "core/gpu/kernel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/gpu/commands.h"
#include "core/gpu/embedded.h"

namespace hermite::gpu::kernel_test {
namespace {

class KernelTest : public testing::Test {
 protected:
  ~KernelTest() override { EXPECT_EQ(device.validation_error_count(), 0); }
  Device device;
};

TEST_F(KernelTest, ReadsItsInterfaceFromTheShader) {
  const Kernel kernel(device, "test/affine");
  EXPECT_EQ(kernel.name(), "test/affine");
  EXPECT_EQ(kernel.bindings().size(), 2u);
  EXPECT_EQ(kernel.push_constant_bytes(), 20u);
  EXPECT_THAT(kernel.local_size(), testing::ElementsAre(8, 2, 1));
}

TEST_F(KernelTest, SpecialisationChangesConstantsAndLocalSize) {
  struct Params {
    std::uint32_t width, height, depth, factor, offset;
  };
  const Kernel kernel(device, "test/affine", {32, 1000});
  EXPECT_THAT(kernel.local_size(), testing::ElementsAre(32, 2, 1));
  Buffer<std::uint32_t> source(device, 100, "source"), target(device, 100, "target");
  source.upload(std::vector<std::uint32_t>(100, 5));
  Commands commands(device);
  commands.dispatch(kernel, {100}, Params{100, 1, 1, 2, 1},
                    {{"source", source}, {"target", target}});
  commands.submit_and_wait();
  EXPECT_EQ(target.download(), std::vector<std::uint32_t>(100, 1011));
}

TEST_F(KernelTest, MovesAndOutlivesItsSource) {
  Kernel kernel(device, "test/count");
  Kernel moved = std::move(kernel);
  moved = Kernel(device, "test/count");
  Buffer<std::uint32_t> counts(device, 3, "counts");
  Commands commands(device);
  commands.dispatch(moved, {3}, {{"counts", counts}});
  commands.submit_and_wait();
  EXPECT_EQ(counts.download(), (std::vector<std::uint32_t>{1, 1, 1}));
}

TEST_F(KernelTest, EveryEmbeddedShaderCompiles) {
  ASSERT_FALSE(embedded_kernels().empty());
  for (const EmbeddedKernel& shader : embedded_kernels()) {
    if (!device.info().has_64_bit_atomics && shader.interface.needs_64_bit_atomics) continue;
    EXPECT_NO_THROW(Kernel(device, shader.name)) << shader.name;
  }
}

TEST_F(KernelTest, AWorkGroupTooLargeForTheDeviceIsAnError) {
  try {
    // Times 2.
    const Kernel kernel(device, "test/affine", {device.limits().maxComputeWorkGroupInvocations, 0});
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("test/affine"));
  }
}

class KernelDeathTest : public KernelTest {
 protected:
  KernelDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(KernelDeathTest, AnUnknownNameIsOurOwnMistake) {
  EXPECT_DEATH(Kernel(device, "test/missing"), "there is no shader 'test/missing'");
}

}  // namespace
}  // namespace hermite::gpu::kernel_test
