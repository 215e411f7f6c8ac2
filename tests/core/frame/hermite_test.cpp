// shaders/lib/hermite.glsl against the same formulas in double precision.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/gpu/buffer.h"
#include "core/gpu/commands.h"
#include "core/gpu/kernel.h"
#include "core/math/hrbf.h"

namespace hermite::frame::hermite_test {
namespace {

using Vector3f = std::array<float, 3>;

struct GpuKernel {
  Vector3f position_m, normal;
  float inverse_radius;
};

struct GpuSample {
  float value;
  Vector3f gradient, diagonal, mixed;
  float support_count, step_m;
  float max_curvature_per_m, min_curvature_per_m;
  float confidence;
};

struct Params {
  std::uint32_t kernel_count, own;
};

Vector3f in_float(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
Eigen::Vector3d in_double(const Vector3f& v) { return {v[0], v[1], v[2]}; }

// A window of 7x7 pixels on a sphere of 0.3 m that bulges towards the camera, one metre away, and
// normals that are off by some degrees.
std::vector<HrbfKernel> kernels_on_a_sphere() {
  std::mt19937 random(7);
  std::normal_distribution<double> off(0, 0.05);
  std::vector<HrbfKernel> kernels;
  for (int y = -3; y <= 3; ++y)
    for (int x = -3; x <= 3; ++x) {
      const Eigen::Vector2d at_m(0.002 * x, 0.002 * y);
      const Eigen::Vector3d centre_m(0, 0, 1.3),
          position_m(at_m.x(), at_m.y(), 1.3 - std::sqrt(0.09 - at_m.squaredNorm()));
      const Eigen::Vector3d normal =
          ((centre_m - position_m).normalized() + Eigen::Vector3d(off(random), off(random), 0))
              .normalized();
      kernels.push_back({in_double(in_float(position_m)), in_double(in_float(normal)), 0.011});
    }
  return kernels;
}

class Hermite : public testing::Test {
 protected:
  ~Hermite() override { EXPECT_EQ(device_.validation_error_count(), 0); }

  std::vector<GpuSample> on_device(const std::vector<HrbfKernel>& kernels,
                                   const std::vector<Vector3f>& rays, std::uint32_t own) {
    std::vector<GpuKernel> given;
    for (const HrbfKernel& k : kernels)
      given.push_back(
          {in_float(k.position_m), in_float(k.normal), static_cast<float>(1 / k.radius_m)});
    gpu::Buffer<GpuKernel> kernel_buffer(device_, given.size(), "kernels");
    gpu::Buffer<Vector3f> ray_buffer(device_, rays.size(), "rays");
    gpu::Buffer<GpuSample> samples(device_, rays.size(), "samples");
    kernel_buffer.upload(given);
    ray_buffer.upload(rays);
    const gpu::Kernel kernel(device_, "test/hermite");
    gpu::Commands commands(device_);
    const Params params{static_cast<std::uint32_t>(given.size()), own};
    commands.dispatch(kernel, {static_cast<std::uint32_t>(rays.size() / 4)}, params,
                      {{"kernels", kernel_buffer}, {"rays", ray_buffer}, {"samples", samples}});
    commands.submit_and_wait();
    return samples.download();
  }

  gpu::Device device_;
};

void expect_near(const Eigen::Vector3d& expected, const Vector3f& actual, double scale,
                 const char* what) {
  EXPECT_LT((expected - in_double(actual)).cwiseAbs().maxCoeff(), scale)
      << what << ": " << expected.transpose() << " and " << in_double(actual).transpose();
}

TEST_F(Hermite, IsTheImplicitFunctionInDoublePrecision) {
  const std::vector<HrbfKernel> kernels = kernels_on_a_sphere();
  const std::size_t own = 24;
  // Around the middle: on the surface, before and behind it, and so far that no kernel reaches.
  std::vector<Vector3f> rays;
  for (const float y : {0.0005f, -0.003f})
    for (const float depth_m : {1.0f, 0.9995f, 1.002f, 1.2f})
      for (const float x : {-0.0047f, 0.0006f, 0.0021f, 0.0052f}) rays.push_back({x, y, depth_m});

  const std::vector<GpuSample> samples = on_device(kernels, rays, own);
  // Length of the gradient [1/m^2].
  const double largest = evaluate_hrbf(kernels, {0, 0, 1}).gradient.norm();
  int reached = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    SCOPED_TRACE(i);
    const Eigen::Vector3d ray(rays[i][0], rays[i][1], 1);
    const GpuSample& actual = samples[i];
    const HrbfSample expected = evaluate_hrbf(kernels, rays[i][2] * ray, own);
    ASSERT_EQ(actual.support_count, static_cast<float>(expected.support_count));
    reached += expected.support_count > 0 ? 1 : 0;
    // A thousandth of what a millimetre changes.
    EXPECT_NEAR(actual.value, expected.value, 1e-3 * 0.001 * largest);
    expect_near(expected.gradient, actual.gradient, 1e-4 * largest, "gradient");
    // A kernel's Hessian goes with 1 / r times its gradient.
    expect_near(expected.hessian.diagonal(), actual.diagonal, 3e-4 * largest / 0.011,
                "Hessian, diagonal");
    expect_near({expected.hessian(0, 1), expected.hessian(0, 2), expected.hessian(1, 2)},
                actual.mixed, 3e-4 * largest / 0.011, "Hessian, mixed");
    if (expected.support_count == 0) {
      EXPECT_EQ(actual.step_m, 0);
      continue;
    }
    const PrincipalCurvatures curvatures =
        *principal_curvatures(expected.gradient, expected.hessian);
    EXPECT_NEAR(actual.max_curvature_per_m, curvatures.max_per_m,
                0.02 + 1e-3 * std::abs(curvatures.max_per_m));
    EXPECT_NEAR(actual.min_curvature_per_m, curvatures.min_per_m,
                0.02 + 1e-3 * std::abs(curvatures.min_per_m));
    EXPECT_NEAR(actual.confidence, hrbf_confidence(expected.gradient, Eigen::Vector3d::UnitZ()),
                1e-4);
  }
  EXPECT_EQ(reached, 24);
}

TEST_F(Hermite, StepsAlongTheRayMeetTheZeroSet) {
  const std::vector<HrbfKernel> kernels = kernels_on_a_sphere();
  std::vector<Vector3f> rays = {{-0.0031f, 0.001f, 1.003f},
                                {0.0f, 0.001f, 1.003f},
                                {0.0016f, 0.001f, 1.003f},
                                {0.0043f, 0.001f, 1.003f}};
  for (int i = 0; i < 8; ++i) {
    const std::vector<GpuSample> samples = on_device(kernels, rays, 0);
    for (std::size_t k = 0; k < rays.size(); ++k) rays[k][2] = samples[k].step_m;
  }
  for (const Vector3f& at : rays) {
    const Eigen::Vector3d ray(at[0], at[1], 1);
    const auto expected = intersect_hrbf(kernels, ray);
    ASSERT_TRUE(expected.has_value());
    EXPECT_NEAR(at[2], expected->ray_parameter, 2e-6);
  }
}

}  // namespace
}  // namespace hermite::frame::hermite_test
