#include "core/math/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace hermite {
namespace {

const Camera kKinect{640, 480, 525, 525, 319.5, 239.5, 5000};

TEST(Camera, ProjectsAndUnprojectsWithIntegerPixelCentres) {
  const Camera camera{640, 480, 500, 510, 320, 240, 1000};
  EXPECT_EQ(camera.project({0, 0, 2}), Eigen::Vector2d(320, 240));
  EXPECT_EQ(camera.project({0.2, -0.1, 2}), Eigen::Vector2d(370, 214.5));
  for (double u : {0.0, 17.25, 639.0})
    for (double v : {0.0, 100.5, 479.0}) {
      const Eigen::Vector3d point = camera.unproject(u, v, 1.7);
      EXPECT_EQ(point.z(), 1.7);
      EXPECT_LT((camera.project(point) - Eigen::Vector2d(u, v)).norm(), 1e-12);
    }
}

TEST(ValidateCamera, AcceptsRealOnes) {
  EXPECT_TRUE(validate(kKinect).ok());
  EXPECT_TRUE(validate({640, 480, 481.2, 480, 319.5, 239.5, 5000}).ok());
  EXPECT_TRUE(validate({1280, 720, 640, 640, 640, 360, 1000}).ok());
  EXPECT_TRUE(validate({kMinImageSide_px, kMaxImageSide_px, 100, 1000, 0, 2047, 1}).ok()) << "the limits themselves are allowed";
}

TEST(ValidateCamera, NamesTheFieldThatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  struct Case {
    const char* field;
    std::function<void(Camera&)> damage;
  };
  const Case cases[] = {
      {"width", [](Camera& c) { c.width = kMinImageSide_px - 1; }},
      {"width", [](Camera& c) { c.width = kMaxImageSide_px + 1; }},
      {"width", [](Camera& c) { c.width = -640; }},
      {"height", [](Camera& c) { c.height = 0; }},
      {"height", [](Camera& c) { c.height = std::numeric_limits<int>::max(); }},
      {"fx", [](Camera& c) { c.fx = 0; }},
      {"fx", [](Camera& c) { c.fx = -525; }},
      {"fx", [=](Camera& c) { c.fx = nan; }},
      {"fx", [](Camera& c) { c.fx = 320 / std::tan(75.5 * M_PI / 180); }},  // 151 degrees wide
      {"fx", [](Camera& c) { c.fx = 320 / std::tan(4.5 * M_PI / 180); }},   // 9 degrees
      {"fy", [=](Camera& c) { c.fy = infinity; }},
      {"fy", [](Camera& c) { c.fy = 1e-300; }},
      {"cx", [](Camera& c) { c.cx = -0.1; }},
      {"cx", [](Camera& c) { c.cx = 639.1; }},
      {"cy", [](Camera& c) { c.cy = 480; }},
      {"cy", [=](Camera& c) { c.cy = nan; }},
      {"depth_units_per_metre", [](Camera& c) { c.depth_units_per_metre = 0.5; }},
      {"depth_units_per_metre", [](Camera& c) { c.depth_units_per_metre = 2e6; }},
      {"depth_units_per_metre", [=](Camera& c) { c.depth_units_per_metre = nan; }},
  };
  for (const Case& test : cases) {
    Camera camera = kKinect;
    test.damage(camera);
    const Status status = validate(camera);
    ASSERT_FALSE(status.ok()) << test.field;
    EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(status.error().message, testing::StartsWith(std::string("camera.") + test.field + " is "));
    EXPECT_THAT(status.error().message, testing::HasSubstr("allowed is"));
  }
}

}  // namespace
}  // namespace hermite
