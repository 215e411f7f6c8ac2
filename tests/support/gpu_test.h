// A fixture with a GPU, opened once per suite, that fails a test which makes the validation layer
// complain. Header only.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "core/gpu/device.h"

namespace hermite::test {

class GpuTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { device_ = std::make_unique<gpu::Device>(); }
  static void TearDownTestSuite() { device_.reset(); }

  ~GpuTest() override { EXPECT_EQ(device_->validation_error_count(), 0); }

  static gpu::Device& device() { return *device_; }

 private:
  static inline std::unique_ptr<gpu::Device> device_;
};

}  // namespace hermite::test
