#include "core/frame/surface_pyramid.h"

#include <gtest/gtest.h>

#include "tests/support/analytic_scene.h"
#include "tests/support/gpu_test.h"
#include "tests/support/packing.h"

namespace hermite::frame::surface_pyramid_test {
namespace {

using test::SurfaceImage;

const Camera kCamera{66, 67, 80, 81, 32.5, 30, 1000};

class SurfacePyramidTest : public test::GpuTest {
 protected:
  SurfacePyramidTest()
      : pyramid(make_surface_pyramid(device(), intrinsics_of(kCamera), "test")),
        kernel(device(), "frame/downsample") {}

  // Levels 1 and 2 from this level 0.
  SurfaceImage level(const SurfaceImage& finest, std::size_t which, double depth_gate_m = 0.05) {
    test::upload(finest, pyramid.levels[0]);
    gpu::Commands commands(device());
    downsample(commands, kernel, pyramid, depth_gate_m);
    commands.submit_and_wait();
    return test::download(pyramid.levels[which]);
  }

  SurfacePyramid pyramid;
  gpu::Kernel kernel;
};

TEST(CoarserCameras, SeeTheSamePointsAtHalfTheResolution) {
  for (int level = 0; level < kPyramidLevels; ++level) {
    const shared::Intrinsics c = test::intrinsics_of_level(kCamera, level);
    const int scale = 1 << level;
    EXPECT_EQ(c.width, static_cast<std::uint32_t>(66 / scale));
    EXPECT_EQ(c.height, static_cast<std::uint32_t>(67 / scale));
    // The centre of coarse pixel (3, 4) lies in the middle of the fine pixels that it covers.
    const double u = 3 * scale + 0.5 * (scale - 1), v = 4 * scale + 0.5 * (scale - 1);
    EXPECT_NEAR((3 - static_cast<double>(c.cx)) / static_cast<double>(c.fx),
                (u - kCamera.cx) / kCamera.fx, 1e-6);
    EXPECT_NEAR((4 - static_cast<double>(c.cy)) / static_cast<double>(c.fy),
                (v - kCamera.cy) / kCamera.fy, 1e-6);
  }
}

TEST_F(SurfacePyramidTest, AFrontalPlaneAndASmoothImageStayWhereTheyAre) {
  const SurfaceImage finest = test::render(test::plane_scene(1.5), pyramid.levels[0].camera);
  for (std::size_t l = 1; l < kPyramidLevels; ++l) {
    const SurfaceImage coarse = level(finest, l);
    const SurfaceImage exact = test::render(test::plane_scene(1.5), coarse.camera);
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      ASSERT_FLOAT_EQ(coarse.depth_m[i], 1.5f);
      ASSERT_LT((coarse.normals[i] - Eigen::Vector3d::UnitZ()).norm(), test::kNormalLoss);
      // A mean over 75 mm flattens waves of 25 cm by up to a seventh of their 100 grey values; half
      // a pixel of offset would cost forty.
      ASSERT_NEAR(static_cast<double>(coarse.intensity[i]), static_cast<double>(exact.intensity[i]),
                  15.0)
          << l << ": " << i;
    }
  }
}

TEST_F(SurfacePyramidTest, AMissingPixelOrAStepLeavesAHole) {
  SurfaceImage finest = test::render(test::plane_scene(1.5), pyramid.levels[0].camera);
  finest.depth_m[finest.index(10, 12)] = 0;
  finest.depth_m[finest.index(21, 13)] += 0.049f;
  finest.depth_m[finest.index(31, 13)] += 0.051f;
  const SurfaceImage coarse = level(finest, 1);
  for (int y = 0; y < static_cast<int>(coarse.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(coarse.camera.width); ++x) {
      const bool hole = (x == 5 && y == 6) || (x == 15 && y == 6);
      const std::size_t i = coarse.index(x, y);
      ASSERT_EQ(coarse.depth_m[i] > 0, !hole) << x << ", " << y;
      ASSERT_EQ(coarse.weight[i] > 0, !hole) << x << ", " << y;
      ASSERT_EQ(coarse.normals[i].isZero(), hole) << x << ", " << y;
      ASSERT_GE(coarse.intensity[i], 0) << "a hole of the surface is none of the image";
    }
}

TEST_F(SurfacePyramidTest, WhereOnePixelHasNoColourTheCoarseOneHasNone) {
  SurfaceImage finest = test::render(test::plane_scene(1.5), pyramid.levels[0].camera);
  finest.intensity[finest.index(9, 9)] = -1;
  const SurfaceImage coarse = level(finest, 1);
  EXPECT_EQ(coarse.intensity[coarse.index(4, 4)], -1);
  EXPECT_GE(coarse.intensity[coarse.index(5, 4)], 0);
  EXPECT_GT(coarse.depth_m[coarse.index(4, 4)], 0) << "nor the other way round";
}

TEST_F(SurfacePyramidTest, MeansAreOfAllFour) {
  SurfaceImage finest = test::render(test::plane_scene(1.5), pyramid.levels[0].camera);
  const std::size_t at[4] = {finest.index(6, 8), finest.index(7, 8), finest.index(6, 9),
                             finest.index(7, 9)};
  for (int i = 0; i < 4; ++i) {
    finest.depth_m[at[i]] = 1.5f + 0.01f * static_cast<float>(i);
    finest.weight[at[i]] = 0.2f * static_cast<float>(i);
    finest.curvatures[at[i]] = {8.0 * i, -4.0 * i};
    finest.normals[at[i]] = Eigen::Vector3d(0.1 * i, 0, 1).normalized();
    finest.intensity[at[i]] = 10.0f * static_cast<float>(i);
  }
  const SurfaceImage coarse = level(finest, 1);
  const std::size_t i = coarse.index(3, 4);
  EXPECT_FLOAT_EQ(coarse.depth_m[i], 1.515f);
  EXPECT_FLOAT_EQ(coarse.weight[i], 0.3f);
  EXPECT_EQ(coarse.curvatures[i], Eigen::Vector2d(12, -6));
  EXPECT_FLOAT_EQ(coarse.intensity[i], 15);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::size_t j : at) sum += finest.normals[j];
  EXPECT_LT((coarse.normals[i] - sum.normalized()).norm(), test::kNormalLoss);
}

}  // namespace
}  // namespace hermite::frame::surface_pyramid_test
