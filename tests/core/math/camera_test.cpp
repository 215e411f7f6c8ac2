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
  EXPECT_TRUE(validate({kMinImageSide_px, kMaxImageSide_px, 100, 1000, 0, 2047, 1}).ok())
      << "the limits themselves are allowed";
}

TEST(ValidateCamera, NamesTheFieldThatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
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
    EXPECT_THAT(status.error().message,
                testing::StartsWith(std::string("camera.") + test.field + " is "));
    EXPECT_THAT(status.error().message, testing::HasSubstr("allowed is"));
  }
}

Camera with_color() {
  Camera camera = kKinect;
  camera.color = ColorCamera{
      525, 525,         320,
      240, {.k1 = 0.1}, {Eigen::Quaterniond(1, 0.004, -0.004, 0.001).normalized(), {-0.025, 0, 0}}};
  return camera;
}

TEST(ValidateCamera, NamesTheFieldOfTheColourCamera) {
  EXPECT_TRUE(validate(with_color()).ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* field;
    std::function<void(ColorCamera&)> damage;
  };
  const Case cases[] = {
      {"fx", [](ColorCamera& c) { c.fx = 0; }},
      {"fy", [=](ColorCamera& c) { c.fy = nan; }},
      {"cx", [](ColorCamera& c) { c.cx = 640; }},
      {"cy", [](ColorCamera& c) { c.cy = -1; }},
      {"distortion", [](ColorCamera& c) { c.distortion.k1 = 20; }},
      {"distortion", [=](ColorCamera& c) { c.distortion.p2 = nan; }},
      {"color_from_depth.rotation",
       [](ColorCamera& c) { c.color_from_depth.rotation.coeffs() *= 1.01; }},
      {"color_from_depth.rotation",
       [](ColorCamera& c) { c.color_from_depth.rotation.coeffs().setZero(); }},
      {"color_from_depth.rotation", [=](ColorCamera& c) { c.color_from_depth.rotation.x() = nan; }},
      {"color_from_depth.translation",
       [](ColorCamera& c) { c.color_from_depth.translation.x() = -0.51; }},
      {"color_from_depth.translation",
       [=](ColorCamera& c) { c.color_from_depth.translation.z() = nan; }},
  };
  for (const Case& test : cases) {
    Camera camera = with_color();
    test.damage(*camera.color);
    const Status status = validate(camera);
    ASSERT_FALSE(status.ok()) << test.field;
    EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(status.error().message,
                testing::StartsWith(std::string("camera.color.") + test.field));
    EXPECT_THAT(status.error().message, testing::HasSubstr("allowed is"));
  }
}

void expect_refused(const Camera& camera, const std::string& field) {
  const Status status = validate(camera);
  ASSERT_FALSE(status.ok()) << field;
  EXPECT_THAT(status.error().message, testing::StartsWith(field));
  EXPECT_THAT(status.error().message, testing::HasSubstr("allowed is"));
}

TEST(ValidateCamera, NamesTheFieldOfTheDepthCorrection) {
  Camera camera = kKinect;
  camera.depth_correction = {kMaxBend, -kMaxInverseOffset_per_m};
  EXPECT_TRUE(validate(camera).ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* field;
    DepthCorrection correction;
  };
  const Case cases[] = {{"bend", {0.11, 0}},
                        {"bend", {nan, 0}},
                        {"inverse_offset_per_m", {0, 0.051}},
                        {"inverse_offset_per_m", {0, nan}}};
  for (const Case& test : cases) {
    camera.depth_correction = test.correction;
    expect_refused(camera, std::string("camera.depth_correction.") + test.field);
  }
}

TEST(ValidateCamera, NamesTheFieldOfTheDeviations) {
  Camera camera = kKinect;
  camera.deviations = {kMaxCameraDeviation, 0, kMaxCameraDeviation};
  EXPECT_TRUE(validate(camera).ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* field;
    CameraDeviations deviations;
  };
  const Case cases[] = {{"bend", {-0.001, 0, 0}}, {"focal", {0, 0.11, 0}}, {"k1", {0, 0, nan}}};
  for (const Case& test : cases) {
    camera.deviations = test.deviations;
    expect_refused(camera, std::string("camera.standard_deviations.") + test.field);
  }
}

TEST(ValidateCamera, NamesTheFieldOfTheTiming) {
  Camera camera = kKinect;
  camera.timing = {kMaxReadout_s, -kMaxReadout_s, -kMaxColorDelay_s};
  EXPECT_TRUE(validate(camera).ok());
  struct Case {
    const char* field;
    ImageTiming timing;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Case cases[] = {{"depth_readout_s", {0.11, 0, 0}},
                        {"color_readout_s", {0, -0.11, 0}},
                        {"color_delay_s", {0, 0, nan}}};
  for (const Case& test : cases) {
    camera.timing = test.timing;
    expect_refused(camera, std::string("camera.timing.") + test.field);
  }
}

TEST(Camera, CorrectsDepth) {
  EXPECT_DOUBLE_EQ(DepthCorrection{}.true_depth_m(1.5, 0.7), 1.5);
  EXPECT_DOUBLE_EQ((DepthCorrection{0.02, 0}).true_depth_m(2, 0.5), 2.02);
  EXPECT_DOUBLE_EQ((DepthCorrection{0, 0.03}).true_depth_m(kUndistortedDepth_m, 1),
                   kUndistortedDepth_m)
      << "the scale stays";
  EXPECT_NEAR(1 / (DepthCorrection{0, 0.03}).true_depth_m(4, 1), (0.25 + 0.03) / 1.06, 1e-12);
  EXPECT_EQ((DepthCorrection{0, -0.05}).true_depth_m(25, 0), 0) << "behind the camera";
  EXPECT_EQ((DepthCorrection{0.02, 0.03}).true_depth_m(0, 0.5), 0);
  EXPECT_DOUBLE_EQ(kKinect.rho2(0, 0), 1);
  EXPECT_DOUBLE_EQ(kKinect.rho2(319.5, 239.5), 0);
}

TEST(Camera, ComparesItsColourCameraToo) {
  EXPECT_EQ(with_color(), with_color());
  EXPECT_NE(with_color(), kKinect);
  Camera other = with_color();
  other.color->color_from_depth.translation.y() = 1e-9;
  EXPECT_NE(other, with_color());
  other = with_color();
  other.color->distortion.k1 = 0;
  EXPECT_NE(other, with_color());
  other = with_color();
  other.depth_correction.bend = 1e-9;
  EXPECT_NE(other, with_color());
}

TEST(Camera, UndistortsWhatItDistorts) {
  Camera camera = kKinect;
  EXPECT_EQ(camera.undistort(17, 401), Eigen::Vector2d(17, 401));
  for (const double k1 : {-0.25, -0.02, 0.05, 0.2}) {
    camera.distortion = {k1, 0.01, 0.001, -0.002, 0};
    for (const double u : {3.0, 320.0, 600.0})
      for (const double v : {2.0, 250.0, 470.0}) {
        const Eigen::Vector2d received_px = camera.distort(u, v),
                              straight_px = camera.undistort(received_px.x(), received_px.y());
        EXPECT_LT((straight_px - Eigen::Vector2d(u, v)).norm(), 1e-2) << k1 << ' ' << u << ' ' << v;
      }
  }
}

TEST(Camera, RectifiedItIsOnePinhole) {
  Camera camera = with_color();
  camera.distortion.k1 = 0.1;
  camera.depth_correction = {0.01, 0.01};
  camera.timing = {0.03, 0.03, 0.01};
  EXPECT_EQ(rectified(camera), kKinect);
}

}  // namespace
}  // namespace hermite
