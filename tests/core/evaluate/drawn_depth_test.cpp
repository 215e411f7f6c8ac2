#include "core/evaluate/drawn_depth.h"

#include <gtest/gtest.h>

#include <limits>

namespace hermite::evaluate {
namespace {

using Eigen::Vector3f;

const Camera kDrawingCamera{64, 64, 60, 60, 31.5, 31.5, 1000};

TEST(DrawnDepth, OfASlantedPlaneIsExactAndEndsWhereItEnds) {
  // z = 2 + x / 2, from x = -0.5 to 0.5.
  const Vector3f a(-0.5f, -3, 1.75f), b(0.5f, -3, 2.25f), c(0.5f, 3, 2.25f), d(-0.5f, 3, 1.75f);
  const Image<float> depth_m = drawn_depth_m({{a, b, c}, {a, c, d}}, kDrawingCamera, Rigid3());
  for (int x = 0; x < 64; ++x) {
    const double slope = (x - kDrawingCamera.cx) / kDrawingCamera.fx,
                 expected_m = 2 / (1 - slope / 2);
    const bool is_there = std::abs(slope * expected_m) < 0.5;
    for (const int y : {0, 20, 63})
      EXPECT_NEAR(depth_m.at(x, y), is_there ? expected_m : 0, 1e-4) << x << " " << y;
  }
}

TEST(DrawnDepth, TheNearestWinsFromEitherSideAndFromElsewhere) {
  const Triangle far{Vector3f(-9, -9, 3), Vector3f(9, -9, 3), Vector3f(0, 9, 3)},
      near{Vector3f(-9, -9, 2), Vector3f(0, 9, 2), Vector3f(9, -9, 2)};
  EXPECT_NEAR(drawn_depth_m({far, near}, kDrawingCamera, Rigid3()).at(32, 32), 2, 1e-6);
  EXPECT_NEAR(drawn_depth_m({near, far}, kDrawingCamera, Rigid3()).at(32, 32), 2, 1e-6);
  const Rigid3 behind{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY())),
                      {0, 0, 10}};
  EXPECT_NEAR(drawn_depth_m({far, near}, kDrawingCamera, behind).at(32, 32), 7, 1e-5);
}

TEST(DrawnDepth, AFloorThatReachesBehindTheCameraIsCutNotLost) {
  const Triangle floor{Vector3f(-50, 1, -50), Vector3f(50, 1, -50), Vector3f(0, 1, 100)};
  const Image<float> depth_m = drawn_depth_m({floor}, kDrawingCamera, Rigid3());
  EXPECT_NEAR(depth_m.at(32, 63), 60 / 31.5, 1e-4);
  EXPECT_EQ(depth_m.at(32, 0), 0) << "above the horizon";
}

TEST(DrawnDepth, WhatIsNotFiniteIsLeftOutAndNothingIsNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Triangle good{Vector3f(-9, -9, 3), Vector3f(9, -9, 3), Vector3f(0, 9, 3)},
      bad{Vector3f(-9, -9, 2), Vector3f(9, nan, 2), Vector3f(0, 9, 2)};
  EXPECT_NEAR(drawn_depth_m({bad, good}, kDrawingCamera, Rigid3()).at(32, 32), 3, 1e-6);
  EXPECT_EQ(drawn_depth_m({}, kDrawingCamera, Rigid3()).at(32, 32), 0);
}

}  // namespace
}  // namespace hermite::evaluate
